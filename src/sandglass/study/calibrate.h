// Finding the strength of the driving at which T is what was asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "sandglass/core/fields.h"
#include "sandglass/core/frame.h"
#include "sandglass/core/progress.h"
#include "sandglass/core/state.h"
#include "sandglass/dynamics/simulation.h"
#include "sandglass/observe/population.h"

namespace sandglass {

/// What is wanted of the steady state.
struct CalibrationGoal {
  double temperature = 1;
  std::optional<double> frequency{};  ///< fixed f_Dr; none: f_Dr = omega, the collision rate at that temperature
  double beat = 1;                    ///< one mean free time by the formula
  double settle = 0;                  ///< collisions per disk to age before calibrating (dense states)
  double temperature_error = 0;       ///< relative error of T to aim at; 0: 0.2 %, below N = 625 0.05 / sqrt(N)
  unsigned threads = 1;
};

/// The values to freeze, and how well they are known.
struct Calibration {
  double frequency = 0, amplitude = 0;
  double temperature_error = 0;  ///< relative standard error of T that the frozen values will give, from their scatter
  double collision_rate = 0;     ///< per disk and time, over the last window
  std::uint64_t windows = 0;
  std::uint64_t converged = 0;  ///< 1 if temperature_error is less than twice what was aimed at

  [[nodiscard]] std::vector<Field> fields();
};

/// Runs a copy of `start`, beat by beat, and adjusts amplitude and frequency together. In a steady state
/// p^2 f = const * T^(3/2) (what kicks put in, collisions at rate omega ~ sqrt(T) take out), so after a window with
/// mean temperature T and rate omega
///   omega' = omega sqrt(T_goal / T),  f' = omega' (or fixed),  p'^2 = p^2 (f / f') (T_goal / T)^(3/2).
/// Two rough windows come first; then the results of 3 to 12 longer ones are averaged until, by their scatter, T is
/// known as well as wanted. A window is as long as a gas would need for sqrt(2) times that: var(T mean) = T^2 2 tau /
/// (N W), tau = 4 / (3 (1 - eps^2)) the relaxation of T in collisions per disk; T of dense and strongly dissipative
/// fluids is correlated for longer. Acts at beats only, in a fixed order: same bits always, also when it is stopped
/// after any beat and a new Calibrator is made of the state of the old one and given its fields.
class Calibrator {
 public:
  Calibrator(State start, const CalibrationGoal& goal);

  [[nodiscard]] bool done() const { return done_ == 1; }
  void advance_one_beat();
  [[nodiscard]] bool window_over() const { return beats_in_window_ >= beats_of_window(); }
  /// To be called after each beat: whether it was the last of a window, at which the drive has changed.
  bool end_window();
  [[nodiscard]] const Calibration& result() const { return result_; }
  /// Of the work, if all windows should be needed.
  [[nodiscard]] double fraction() const;

  [[nodiscard]] Simulation& simulation() { return simulation_; }  ///< the copy that is run
  [[nodiscard]] std::vector<Field> fields();
  [[nodiscard]] bool valid() const;  ///< whether the place can be (after fields() were restored)

 private:
  /// Mean and its standard error of the results of a few windows, in the order in which they came.
  struct Average {
    double sum = 0, squares = 0;
    std::uint64_t count = 0;

    void add(double value);
    [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
    [[nodiscard]] double relative_error() const;
  };

  [[nodiscard]] bool rough() const;
  [[nodiscard]] std::uint64_t beats_before_measuring() const;
  [[nodiscard]] std::uint64_t beats_of_window() const;

  CalibrationGoal goal_;
  double error_;           // relative, of T, to be reached
  double settling_beats_;  // at the start of each window
  double measured_beats_;  // of a window that is not rough
  Population population_;
  Frame frame_;
  Snapshot snapshot_;
  Simulation simulation_;

  Calibration result_;
  Average frequencies_, amplitudes_;
  std::uint64_t beats_ = 0, window_ = 0, beats_in_window_ = 0, collisions_before_ = 0, done_ = 0;
  double temperature_sum_ = 0;
};

/// The same in one go.
Calibration calibrate(State start, const CalibrationGoal& goal, const Progress& progress = {});

}  // namespace sandglass
