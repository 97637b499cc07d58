#include "sandglass/study/campaign_run.h"

#include <fmt/format.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <fstream>
#include <set>
#include <thread>

#include "sandglass/core/errors.h"
#include "sandglass/study/campaign_status.h"
#include "sandglass/study/child_process.h"
#include "sandglass/study/cost.h"
#include "sandglass/study/memory.h"
#include "sandglass/study/run_progress.h"

namespace sandglass {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto pause = std::chrono::milliseconds(50);
constexpr auto between_reports = std::chrono::milliseconds(500);
constexpr auto between_looks = std::chrono::seconds(2);  // at points of other processes
constexpr int most_fruitless = 3;

struct Point {
  const ManifestRow* row;
  std::filesystem::path folder;
  double cost = 0, memory = 0;
  int fruitless = 0;          // attempts in a row that were cut off without a new checkpoint
  double fraction_shown = 0;  // of its progress
  bool done = false;

  [[nodiscard]] std::filesystem::path log() const { return folder / "output.log"; }
  /// The report comes last of all.
  [[nodiscard]] bool finished() const {
    return std::filesystem::exists(folder / "summary.json") && std::filesystem::exists(folder / "report.html");
  }
  [[nodiscard]] std::filesystem::file_time_type checkpoint_time() const {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(folder / "checkpoint.h5", error);
    return error ? std::filesystem::file_time_type::min() : time;
  }
};

struct Child {
  Point* point;
  pid_t process;
  std::uintmax_t log_start;
  std::filesystem::file_time_type checkpoint_before;
};

class CampaignRun {
 public:
  CampaignRun(const std::filesystem::path& manifest_file, std::size_t jobs, const CampaignMonitor& monitor,
              std::string program)
      : manifest_file_(manifest_file),
        manifest_(read_manifest(manifest_file)),
        jobs_(jobs),
        monitor_(monitor),
        program_(std::move(program)),
        memory_(available_memory()) {}

  CampaignResult go() {
    list_points();
    while (!(children_.empty() && (result_.stopped || (pending_.empty() && elsewhere_.empty())))) {
      if (!result_.stopped && monitor_.stop_requested && monitor_.stop_requested()) stop();
      reap();
      if (!result_.stopped) {
        look_elsewhere();
        start_more();
      }
      if (Clock::now() - reported_ > between_reports) report();
      if (!children_.empty() || !elsewhere_.empty()) std::this_thread::sleep_for(pause);
    }
    report();
    return std::move(result_);
  }

 private:
  void list_points() {
    for (const ManifestRow& row : manifest_.rows) {
      Point& point = points_.emplace_back(Point{.row = &row, .folder = manifest_.run_folder(row)});
      try {
        const Config config = read_point(manifest_, row);
        point.cost = reference_seconds(config);
        most_threads_ = std::max<std::size_t>(most_threads_, config.run.threads);
        point.memory = needed_memory(config.system.particles);
      } catch (const InputError& error) {
        fail(point, error.what());
        continue;
      }
      if (const auto progress = read_progress(point.folder)) point.fraction_shown = progress->fraction;
      if (point.finished() && !is_running(point.folder))
        point.done = true;
      else
        pending_.push_back(&point);
    }
    std::stable_sort(pending_.begin(), pending_.end(),
                     [](const Point* a, const Point* b) { return a->cost > b->cost; });
    if (jobs_ == 0) jobs_ = std::max<std::size_t>(1, usable_cores() / most_threads_);
  }

  void start_more() {
    while (children_.size() < jobs_ && !pending_.empty()) {
      const auto fitting = std::find_if(pending_.begin(), pending_.end(), [&](const Point* p) { return fits(*p); });
      if (fitting == pending_.end()) return;
      Point& point = **fitting;
      pending_.erase(fitting);
      if (is_running(point.folder))
        elsewhere_.push_back(&point);
      else if (point.finished())
        point.done = true;
      else
        start(point);
    }
  }

  /// Whether memory holds the point beside those that run; one alone is always tried.
  [[nodiscard]] bool fits(const Point& point) const {
    double needed = point.memory;
    for (const Child& child : children_) needed += child.point->memory;
    return children_.empty() || needed <= memory_;
  }

  void start(Point& point) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(point.log(), error);
    try {
      const pid_t process = start_process(
          program_,
          {"sandglass", "run", "--manifest", manifest_file_.string(), "--index", fmt::format("{}", point.row->index)},
          point.log());
      children_.push_back({&point, process, error ? 0 : size, point.checkpoint_time()});
    } catch (const std::exception& problem) {
      fail(point, problem.what());
    }
  }

  void reap() {
    for (std::size_t i = 0; i < children_.size();) {
      const auto end = ended(children_[i].process);
      if (!end) {
        ++i;
        continue;
      }
      const Child child = children_[i];
      children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
      judge(child, *end);
    }
  }

  void judge(const Child& child, const ProcessEnd& end) {
    Point& point = *child.point;
    constexpr std::array cut_off{SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGXCPU};
    const bool interrupted = end.exit_code == static_cast<int>(ExitCode::resumable) ||
                             std::find(cut_off.begin(), cut_off.end(), end.signal) != cut_off.end();
    if (end.signal == 0 && end.exit_code == 0) {
      point.done = true;
    } else if (interrupted) {
      const bool further = point.checkpoint_time() > child.checkpoint_before;
      point.fruitless = further ? 0 : point.fruitless + 1;
      if (result_.stopped || point.fruitless < most_fruitless)
        pending_.push_front(&point);
      else
        fail(point, fmt::format("it was stopped {} times without getting further", most_fruitless));
    } else if (is_running(point.folder)) {
      elsewhere_.push_back(&point);
    } else if (point.finished()) {  // by another process, which held it when this one came
      point.done = true;
    } else if (end.signal != 0) {
      fail(point, fmt::format("it was ended by signal {} ({})", end.signal, ::strsignal(end.signal)));
    } else {
      const std::string line = last_line(point.log(), child.log_start);
      fail(point, line.empty() ? fmt::format("exit code {}", end.exit_code) : line);
    }
  }

  void fail(Point& point, const std::string& reason) {
    result_.failed.push_back({point.row->index, point.row->path, reason});
    std::string text = fmt::format("point {} failed: {}", point.row->index, reason);
    if (std::filesystem::exists(point.log())) text += fmt::format("\n  what it printed: {}", point.log().string());
    if (monitor_.message) monitor_.message(text);
  }

  /// Points of other processes, now and then: finished, or left to be taken up.
  void look_elsewhere() {
    if (elsewhere_.empty() || Clock::now() - looked_ < between_looks) return;
    looked_ = Clock::now();
    for (std::size_t i = elsewhere_.size(); i-- > 0;) {
      Point* point = elsewhere_[i];
      if (is_running(point->folder)) continue;
      elsewhere_.erase(elsewhere_.begin() + static_cast<std::ptrdiff_t>(i));
      pending_.push_front(point);
    }
  }

  void stop() {
    result_.stopped = true;
    for (const Child& child : children_) ::kill(child.process, SIGTERM);
  }

  void report() {
    reported_ = Clock::now();
    for (const Child& child : children_)
      if (const auto progress = read_progress(child.point->folder)) child.point->fraction_shown = progress->fraction;
    CampaignProgress& progress = result_.progress;
    progress = {.points = points_.size(),
                .done = 0,
                .running = children_.size(),
                .elsewhere = elsewhere_.size(),
                .failed = result_.failed.size(),
                .fraction = 0};
    double all = 0, worked = 0;
    for (const Point& point : points_) {
      progress.done += point.done ? 1 : 0;
      all += point.cost;
      worked += point.cost * (point.done ? 1 : point.fraction_shown);
    }
    progress.fraction = all > 0 ? worked / all : 1;
    if (monitor_.progress) monitor_.progress(progress);
  }

  std::filesystem::path manifest_file_;
  Manifest manifest_;
  std::size_t jobs_, most_threads_ = 1;
  const CampaignMonitor& monitor_;
  std::string program_;
  double memory_;
  std::deque<Point> points_;  // addresses stay
  std::deque<Point*> pending_;
  std::vector<Point*> elsewhere_;
  std::vector<Child> children_;
  Clock::time_point looked_{}, reported_{};
  CampaignResult result_;
};

}  // namespace

std::size_t usable_cores() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0) return std::max(1u, std::thread::hardware_concurrency());
  std::set<std::string> cores;
  for (int thread = 0; thread < CPU_SETSIZE; ++thread) {
    if (!CPU_ISSET(thread, &allowed)) continue;
    std::ifstream file(fmt::format("/sys/devices/system/cpu/cpu{}/topology/thread_siblings_list", thread));
    std::string siblings;
    if (!std::getline(file, siblings)) siblings = fmt::format("{}", thread);
    cores.insert(siblings);
  }
  return std::max<std::size_t>(1, cores.size());
}

CampaignResult run_campaign(const std::filesystem::path& manifest_file, std::size_t jobs,
                            const CampaignMonitor& monitor, const std::string& program) {
  return CampaignRun(manifest_file, jobs, monitor, program).go();
}

}  // namespace sandglass
