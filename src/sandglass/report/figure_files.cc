#include "sandglass/report/figure_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/report/figure_json.h"
#include "sandglass/report/page_files.h"

extern char** environ;

namespace sandglass {
namespace {

namespace fs = std::filesystem;

constexpr int no_matplotlib = 3;  // exit code of the script

bool has_data(const Figure& figure) {
  if (!figure.empty()) return true;
  for (const Figure& panel : figure.panels)
    if (!panel.empty()) return true;
  return false;
}

/// Runs a program without a shell; its exit code, or -1 when a signal ended it. Throws RunError if it does not start.
int run_program(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  const int failure = posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), environ);
  if (failure != 0)
    throw RunError(
        fmt::format("the pictures were not drawn: {} does not start ({}). Install python3-matplotlib, or "
                    "name a Python that has matplotlib in SANDGLASS_PYTHON; the data are written",
                    words[0], std::strerror(failure)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

void write_figure_data(const std::vector<Figure>& figures, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  for (const Figure& figure : figures) {
    for (const char* format : {".svg", ".pdf", ".png"}) fs::remove(folder / (figure.id + format), error);
    write_whole(folder / (figure.id + ".csv"), figure_csv(figure));
    write_whole(folder / (figure.id + ".json"),
                figure_json(figure).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  }
}

void draw_figures(const std::vector<Figure>& figures, const fs::path& folder, const std::vector<std::string>& formats) {
  const char* chosen = std::getenv("SANDGLASS_PYTHON");
  const std::string python = chosen != nullptr && *chosen != '\0' ? chosen : "/usr/bin/python3";
  std::vector<std::string> words{python, "-B", "-c", std::string(page_files::python_drawing),
                                 fmt::format("--format={}", fmt::join(formats, ","))};
  const std::size_t options = words.size();
  for (const Figure& figure : figures)
    if (has_data(figure)) words.push_back((fs::absolute(folder) / (figure.id + ".json")).string());
  if (words.size() == options || formats.empty()) return;
  const int code = run_program(std::move(words));
  if (code == no_matplotlib)
    throw RunError(
        fmt::format("the pictures were not drawn: {} has no matplotlib. Install python3-matplotlib, or name a "
                    "Python that has it in SANDGLASS_PYTHON; the data are written",
                    python));
  if (code != 0)
    throw RunError(
        fmt::format("the pictures were not drawn: {} failed (exit code {}); its message stands above, the "
                    "data are written",
                    python, code));
}

}  // namespace sandglass
