// The frames of the trajectory, written while a run goes on.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "sandglass/io/atomic_file.h"
#include "sandglass/io/trajectory.h"
#include "sandglass/observe/observer.h"
#include "sandglass/observe/schedule.h"

namespace sandglass {

/// An Observer that stores the frames of the trajectory, evenly spaced over the measured stretch, both ends included.
class FrameWriter {
 public:
  FrameWriter(std::filesystem::path path, std::uint64_t frames, double box_length)
      : path_(std::move(path)), frames_(frames), box_length_(box_length) {}

  void begin(const MeasurementPlan& plan) { plan_ = plan; }

  [[nodiscard]] double next_sample() const {
    if (!plan_ || written_ >= frames_) return std::numeric_limits<double>::infinity();
    if (frames_ == 1) return plan_->end();
    const double step = (plan_->end() - plan_->start) / static_cast<double>(frames_ - 1);
    return written_ + 1 == frames_ ? plan_->end() : plan_->start + static_cast<double>(written_) * step;
  }
  void sample(const Frame& frame) {
    const double collisions = frame.collisions_per_disk * static_cast<double>(frame.size()) / 2;
    write_frame(path_, written_++, std::llround(collisions), frame, box_length_);
  }
  void merge(const FrameWriter&) {}  // two trajectories stay two files
  /// What was written is on the disk before a checkpoint says so.
  void sync() const {
    if (written_ > 0) sync_file(path_);
  }
  /// After fields() were restored: whether the next frame is still to come at time `now`.
  [[nodiscard]] bool valid(double now) const {
    return written_ <= frames_ && (plan_ || written_ == 0) && next_sample() >= now * (1 - 1e-9);
  }
  [[nodiscard]] std::vector<Field> fields() { return {{"written", &written_}}; }
  [[nodiscard]] std::vector<Dataset> results() const { return {}; }

 private:
  std::filesystem::path path_;
  std::uint64_t frames_, written_ = 0;
  double box_length_;
  std::optional<MeasurementPlan> plan_;
};
static_assert(Observer<FrameWriter>);

}  // namespace sandglass
