#include "sandglass/study/calibrate.h"

#include <cmath>

namespace sandglass {
namespace {

constexpr std::uint64_t rough_windows = 2, least_windows = 3, most_windows = 12;

// Relative standard error of T to be reached: 0.2 %, but in small systems no better than a twentieth of the spread of T
// itself, 1/sqrt(N).
double wanted_error(double disks) { return std::fmax(0.002, 0.05 / std::sqrt(disks)); }

}  // namespace

void Calibrator::Average::add(double value) {
  sum += value;
  squares += value * value;
  ++count;
}

double Calibrator::Average::relative_error() const {
  const auto n = static_cast<double>(count);
  const double variance = std::fmax(squares / n - mean() * mean(), 0.0);
  return std::sqrt(variance / (n - 1)) / mean();
}

Calibrator::Calibrator(State start, const CalibrationGoal& goal)
    : goal_(goal),
      error_(goal.temperature_error > 0 ? goal.temperature_error : wanted_error(static_cast<double>(start.size()))),
      population_(population_of(start)),
      simulation_(start, {.threads = goal.threads}),
      result_{.frequency = start.drive.frequency, .amplitude = start.drive.amplitude} {
  const double restitution = start.collision.restitution;
  const double relaxation = 4 / (3 * (1 - restitution * restitution));
  settling_beats_ = std::ceil(5 * relaxation);
  const double length = relaxation / (static_cast<double>(start.size()) * error_ * error_);
  measured_beats_ = std::fmin(std::fmax(length, 25.0), 5e3);
}

bool Calibrator::rough() const { return window_ < rough_windows; }

/// Ageing happens once, when the temperature is about right.
std::uint64_t Calibrator::beats_before_measuring() const {
  return static_cast<std::uint64_t>(settling_beats_) +
         (window_ == rough_windows ? static_cast<std::uint64_t>(goal_.settle) : 0);
}

std::uint64_t Calibrator::beats_of_window() const {
  const double measured = rough() ? measured_beats_ / 2 : measured_beats_;
  return beats_before_measuring() + static_cast<std::uint64_t>(std::ceil(measured));
}

double Calibrator::fraction() const {
  const double within = static_cast<double>(beats_in_window_) / static_cast<double>(beats_of_window());
  return done() ? 1 : (static_cast<double>(window_) + within) / static_cast<double>(rough_windows + most_windows);
}

void Calibrator::advance_one_beat() {
  if (beats_in_window_ == beats_before_measuring()) {
    collisions_before_ = simulation_.tally().collisions();
    temperature_sum_ = 0;
  }
  simulation_.run_until(static_cast<double>(++beats_) * goal_.beat);
  if (++beats_in_window_ <= beats_before_measuring()) return;
  simulation_.make_frame(frame_);
  take_snapshot(frame_, population_, snapshot_);
  temperature_sum_ += temperatures(snapshot_, population_).all;
}

bool Calibrator::end_window() {
  if (!window_over()) return false;
  const auto measured = static_cast<double>(beats_of_window() - beats_before_measuring());
  const auto collisions = static_cast<double>(simulation_.tally().collisions() - collisions_before_);
  const double ratio = goal_.temperature / (temperature_sum_ / measured);
  ++result_.windows;
  result_.collision_rate = 2 * collisions / (static_cast<double>(simulation_.size()) * (measured * goal_.beat));

  const double frequency = goal_.frequency.value_or(result_.collision_rate * std::sqrt(ratio));
  const double amplitude = result_.amplitude * std::sqrt(result_.frequency / frequency * ratio * std::sqrt(ratio));
  if (rough()) {
    result_.frequency = frequency;
    result_.amplitude = amplitude;
  } else {
    frequencies_.add(frequency);
    amplitudes_.add(amplitude);
    result_.frequency = frequencies_.mean();
    result_.amplitude = amplitudes_.mean();
    if (amplitudes_.count >= least_windows) {
      result_.temperature_error = 2 * amplitudes_.relative_error();  // T ~ p^2
      result_.converged = result_.temperature_error < 2 * error_;
      done_ = result_.temperature_error < error_ || amplitudes_.count == most_windows;
    }
  }
  ++window_;
  beats_in_window_ = 0;
  if (done()) return true;
  State state = simulation_.state();
  change_drive(state, result_.frequency, result_.amplitude);
  simulation_ = Simulation(std::move(state), {.threads = goal_.threads});
  return true;
}

std::vector<Field> Calibration::fields() {
  return {{"frequency", &frequency},           {"amplitude", &amplitude}, {"temperature_error", &temperature_error},
          {"collision_rate", &collision_rate}, {"windows", &windows},     {"converged", &converged}};
}

std::vector<Field> Calibrator::fields() {
  std::vector<Field> fields = result_.fields();
  for (const Field& own : std::initializer_list<Field>{{"beats", &beats_},
                                                       {"window", &window_},
                                                       {"beats_in_window", &beats_in_window_},
                                                       {"collisions_before", &collisions_before_},
                                                       {"temperature_sum", &temperature_sum_},
                                                       {"frequencies_sum", &frequencies_.sum},
                                                       {"frequencies_squares", &frequencies_.squares},
                                                       {"frequencies_count", &frequencies_.count},
                                                       {"amplitudes_sum", &amplitudes_.sum},
                                                       {"amplitudes_squares", &amplitudes_.squares},
                                                       {"amplitudes_count", &amplitudes_.count},
                                                       {"done", &done_}})
    fields.push_back(own);
  return fields;
}

bool Calibrator::valid() const {
  const auto number = [](double value) { return std::isfinite(value) && value >= 0; };
  const bool counted = done_ <= 1 && window_ <= rough_windows + most_windows && beats_in_window_ <= beats_of_window() &&
                       beats_in_window_ <= beats_ && collisions_before_ <= simulation_.tally().collisions() &&
                       frequencies_.count == amplitudes_.count && amplitudes_.count <= window_;
  const double time = static_cast<double>(beats_) * goal_.beat;
  return counted && std::fabs(simulation_.time() - time) <= 1e-9 * time && result_.frequency > 0 &&
         result_.amplitude > 0 && number(result_.frequency) && number(result_.amplitude) && number(temperature_sum_) &&
         number(frequencies_.sum) && number(frequencies_.squares) && number(amplitudes_.sum) &&
         number(amplitudes_.squares);
}

Calibration calibrate(State start, const CalibrationGoal& goal, const Progress& progress) {
  Calibrator calibrator(std::move(start), goal);
  while (!calibrator.done()) {
    report_progress(progress, "calibrating the drive", calibrator.fraction());  // also where the caller may stop it
    calibrator.advance_one_beat();
    calibrator.end_window();
  }
  report_progress(progress, "calibrating the drive", 1);
  return calibrator.result();
}

}  // namespace sandglass
