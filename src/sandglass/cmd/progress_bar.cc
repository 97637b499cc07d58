#include "sandglass/cmd/progress_bar.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "sandglass/cmd/text.h"

namespace sandglass {

ProgressBar::ProgressBar() : terminal_(::isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (line_open_) fmt::print(stderr, "\n");
}

void ProgressBar::begin_stage(std::string_view name, double fraction) {
  if (line_open_) fmt::print(stderr, "\n");
  stage_ = name;
  first_fraction_ = fraction;
  stage_began_ = Clock::now();
  last_shown_ = {};
}

void ProgressBar::show(std::string_view stage, double fraction) {
  const std::string_view name = stage.substr(0, stage.find(" ("));
  if (name != stage_) begin_stage(name, fraction);
  const auto now = Clock::now();
  const auto pause = terminal_ ? std::chrono::milliseconds(200) : std::chrono::seconds(30);
  if (now - last_shown_ < pause && !(terminal_ && fraction >= 1)) return;
  last_shown_ = now;

  const double elapsed = std::chrono::duration<double>(now - stage_began_).count();
  const double done = fraction - first_fraction_;
  const std::string left = done > 0.005 && elapsed > 1 && fraction < 1
                               ? ", " + duration_text(elapsed * (1 - fraction) / done) + " left"
                               : "";
  if (!terminal_) {
    fmt::print(stderr, "{}: {:.0f} %{}\n", stage, 100 * fraction, left);
    return;
  }
  constexpr int width = 30;
  const int filled = std::clamp(static_cast<int>(fraction * width), 0, width);
  fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {:3.0f} %  {}{}", "", filled, "", width - filled, 100 * fraction, stage,
             left);
  std::fflush(stderr);
  line_open_ = true;
}

}  // namespace sandglass
