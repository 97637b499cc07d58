#include "sandglass/report/report.h"

#include <functional>

#include "sandglass/core/errors.h"
#include "sandglass/io/atomic_file.h"
#include "sandglass/io/checkpoint.h"
#include "sandglass/io/summary.h"
#include "sandglass/report/run_page.h"
#include "sandglass/study/results.h"

namespace sandglass {
namespace {

/// Why `read` could not read; empty when it could.
std::string failure_of(const std::function<void()>& read) {
  try {
    read();
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

}  // namespace

void write_report(const std::filesystem::path& run_folder) {
  constexpr std::size_t longest_config = 1 << 20;
  RunRecord run;
  run.summary = read_summary(run_folder / "summary.json");
  failure_of([&] { run.config_toml = read_whole(run_folder / "config.toml", longest_config); });
  run.results_missing = failure_of([&] { run.results = read_results(run_folder / "observables.h5"); });
  run.packing_missing =
      failure_of([&] { run.packing = packing_of(read_checkpoint(run_folder / "checkpoint.h5", {}).state); });
  write_whole(run_folder / "report.html", page_html(run_page(run)));
}

}  // namespace sandglass
