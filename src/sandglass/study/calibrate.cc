#include "sandglass/study/calibrate.h"

#include <cmath>

#include "sandglass/dynamics/simulation.h"
#include "sandglass/observe/population.h"

namespace sandglass {
namespace {

constexpr int most_windows = 8;

// Relative standard error of T to be reached: 0.2 %, but in small systems no better than a twentieth of the spread of T
// itself, 1/sqrt(N).
double wanted_error(double disks) { return std::fmax(0.002, 0.05 / std::sqrt(disks)); }

struct Window {
  double temperature, collision_rate;
};

/// The scratch run: counts beats, measures windows of them.
class Scratch {
 public:
  Scratch(State state, double beat) : population_(population_of(state)), beat_(beat), simulation_(std::move(state)) {}

  void run(std::uint64_t beats) { simulation_.run_until(static_cast<double>(beats_ += beats) * beat_); }

  Window measure(std::uint64_t beats) {
    const std::uint64_t before = simulation_.tally().collisions();
    double sum = 0;
    for (std::uint64_t i = 0; i < beats; ++i) {
      run(1);
      simulation_.make_frame(frame_);
      take_snapshot(frame_, population_, snapshot_);
      sum += temperatures(snapshot_, population_).all;
    }
    const auto collisions = static_cast<double>(simulation_.tally().collisions() - before);
    const auto duration = static_cast<double>(beats) * beat_;
    return {sum / static_cast<double>(beats), 2 * collisions / (static_cast<double>(simulation_.size()) * duration)};
  }

  void drive(double frequency, double amplitude) {
    State state = simulation_.state();
    change_drive(state, frequency, amplitude);
    simulation_ = Simulation(std::move(state));
  }

 private:
  Population population_;
  double beat_;
  std::uint64_t beats_ = 0;
  Simulation simulation_;
  Frame frame_;
  Snapshot snapshot_;
};

}  // namespace

Calibration calibrate(State start, const CalibrationGoal& goal, const Progress& progress) {
  const auto disks = static_cast<double>(start.size());
  const double restitution = start.collision.restitution;
  const double relaxation = 4 / (3 * (1 - restitution * restitution));
  const double error = wanted_error(disks);
  const double full = std::fmin(std::fmax(2 * relaxation / (disks * error * error), 50.0), 1e4);
  const auto settling = static_cast<std::uint64_t>(std::ceil(5 * relaxation));

  Calibration result{.frequency = start.drive.frequency, .amplitude = start.drive.amplitude};
  Scratch scratch(std::move(start), goal.beat);
  for (int window = 0; window < most_windows && !result.converged; ++window) {
    report_progress(progress, "calibrating the drive", window / static_cast<double>(most_windows));
    // Rough first, exact when the drive is nearly right. Ageing happens once, when the temperature is.
    if (window == 2) scratch.run(static_cast<std::uint64_t>(goal.settle));
    const auto beats = static_cast<std::uint64_t>(std::ceil(window < 2 ? full / 4 : full));
    scratch.run(settling);
    const auto [temperature, rate] = scratch.measure(beats);
    ++result.windows;
    result.temperature = temperature;
    result.temperature_error = std::sqrt(2 * relaxation / (disks * static_cast<double>(beats)));
    result.collision_rate = rate;

    const double ratio = goal.temperature / temperature;
    const double frequency = goal.frequency.value_or(rate * std::sqrt(ratio));
    result.converged =
        window >= 2 && std::fabs(ratio - 1) < 2 * error && std::fabs(frequency / result.frequency - 1) < 0.01;
    result.amplitude *= std::sqrt(result.frequency / frequency * ratio * std::sqrt(ratio));
    result.frequency = frequency;
    if (!result.converged) scratch.drive(result.frequency, result.amplitude);
  }
  report_progress(progress, "calibrating the drive", 1);
  return result;
}

}  // namespace sandglass
