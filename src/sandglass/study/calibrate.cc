#include "sandglass/study/calibrate.h"

#include <cmath>

#include "sandglass/dynamics/simulation.h"
#include "sandglass/observe/population.h"

namespace sandglass {
namespace {

constexpr int rough_windows = 2, least_windows = 3, most_windows = 12;

// Relative standard error of T to be reached: 0.2 %, but in small systems no better than a twentieth of the spread of T
// itself, 1/sqrt(N).
double wanted_error(double disks) { return std::fmax(0.002, 0.05 / std::sqrt(disks)); }

/// Mean and its standard error of a few values, in the order in which they came.
struct Average {
  double sum = 0, squares = 0;
  int count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    ++count;
  }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double relative_error() const {
    const double variance = std::fmax(squares / count - mean() * mean(), 0.0);
    return std::sqrt(variance / (count - 1)) / mean();
  }
};

struct Window {
  double temperature, collision_rate;
};

/// The scratch run: counts beats, measures windows of them.
class Scratch {
 public:
  Scratch(State state, double beat, unsigned threads, const Progress& progress)
      : population_(population_of(state)),
        beat_(beat),
        progress_(progress),
        tuning_{.threads = threads},
        simulation_(std::move(state), tuning_) {}

  void set_progress(double fraction) { fraction_ = fraction; }

  void run(std::uint64_t beats) {
    for (std::uint64_t i = 0; i < beats; ++i) {
      report_progress(progress_, "calibrating the drive", fraction_);  // also where the caller may stop it
      simulation_.run_until(static_cast<double>(++beats_) * beat_);
    }
  }

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
    simulation_ = Simulation(std::move(state), tuning_);
  }

 private:
  Population population_;
  double beat_;
  const Progress& progress_;
  double fraction_ = 0;
  std::uint64_t beats_ = 0;
  Tuning tuning_;
  Simulation simulation_;
  Frame frame_;
  Snapshot snapshot_;
};

}  // namespace

Calibration calibrate(State start, const CalibrationGoal& goal, const Progress& progress) {
  const auto disks = static_cast<double>(start.size());
  const double restitution = start.collision.restitution;
  const double relaxation = 4 / (3 * (1 - restitution * restitution));
  const double error = goal.temperature_error > 0 ? goal.temperature_error : wanted_error(disks);
  const double length = std::fmin(std::fmax(relaxation / (disks * error * error), 25.0), 5e3);
  const auto settling = static_cast<std::uint64_t>(std::ceil(5 * relaxation));

  Calibration result{.frequency = start.drive.frequency, .amplitude = start.drive.amplitude};
  Scratch scratch(std::move(start), goal.beat, goal.threads, progress);
  Average frequencies, amplitudes;
  for (int window = 0; amplitudes.count < most_windows; ++window) {
    const bool rough = window < rough_windows;
    scratch.set_progress(window / static_cast<double>(rough_windows + most_windows));
    // Ageing happens once, when the temperature is about right.
    if (window == rough_windows) scratch.run(static_cast<std::uint64_t>(goal.settle));
    scratch.run(settling);
    const auto [temperature, rate] =
        scratch.measure(static_cast<std::uint64_t>(std::ceil(rough ? length / 2 : length)));
    ++result.windows;
    result.collision_rate = rate;

    const double ratio = goal.temperature / temperature;
    const double frequency = goal.frequency.value_or(rate * std::sqrt(ratio));
    const double amplitude = result.amplitude * std::sqrt(result.frequency / frequency * ratio * std::sqrt(ratio));
    if (rough) {
      result.frequency = frequency;
      result.amplitude = amplitude;
    } else {
      frequencies.add(frequency);
      amplitudes.add(amplitude);
      result.frequency = frequencies.mean();
      result.amplitude = amplitudes.mean();
      if (amplitudes.count >= least_windows) {
        result.temperature_error = 2 * amplitudes.relative_error();  // T ~ p^2
        result.converged = result.temperature_error < 2 * error;
        if (result.temperature_error < error) break;
      }
    }
    scratch.drive(result.frequency, result.amplitude);
  }
  report_progress(progress, "calibrating the drive", 1);
  return result;
}

}  // namespace sandglass
