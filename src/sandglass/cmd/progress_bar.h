// Progress on the terminal: a bar with rate and time left, or plain lines where there is no terminal.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace sandglass {

/// Shows each stage from its first report on. On a terminal one line is redrawn a few times a second; otherwise a line
/// is printed when a stage begins and then at most twice a minute. A stage may carry a remark in brackets, such as a
/// rate, which does not make it another stage.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();  ///< leaves the cursor on a fresh line
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(std::string_view stage, double fraction);

 private:
  using Clock = std::chrono::steady_clock;
  void begin_stage(std::string_view name, double fraction);

  bool terminal_;
  bool line_open_ = false;
  std::string stage_;
  double first_fraction_ = 0;
  Clock::time_point stage_began_{}, last_shown_{};
};

}  // namespace sandglass
