// What single disks do: overlap and its fluctuations, displacements relative to the cage, their distribution, the fast
// and the slow. Against theory for disks that walk independently; the brute-force comparison is tests/cli/analyze.py.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "sandglass/core/random.h"
#include "sandglass/observe/correlator.h"
#include "sandglass/observe/van_hove.h"

using namespace sandglass;

namespace {

constexpr int rows = 28, columns = 24;
constexpr double spacing = 2.2, length = columns * spacing;

// A triangular lattice (stretched by 1 % to fit its box), all disks small but every seventh row.
State lattice() {
  State state;
  state.box_length = length;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      Disk& disk = state.disks.emplace_back();
      disk.x = spacing * (column + 0.5 * (row % 2));
      disk.y = length * row / rows;
      disk.species = row % 7 == 3 ? big : small;
    }
  }
  return state;
}

const std::vector<double>& values(const std::vector<Dataset>& results, const std::string& path) {
  for (const Dataset& d : results)
    if (d.path == path) return std::get<std::vector<double>>(d.values);
  FAIL("no dataset " << path);
  throw;
}

}  // namespace

TEST_CASE("independent Gaussian walkers: overlap, chi_4, cage, van Hove, fastest and slowest as derived") {
  MeasurementPlan plan;
  plan.start = 0, plan.interval_length = 2, plan.intervals = 40;
  plan.shortest_lag = 0.02, plan.lags_per_decade = 3, plan.origins = 1, plan.wavenumbers = {1};
  plan.overlap_length = 0.5;
  const State state = lattice();
  const Population population = population_of(state);
  Correlator correlator(plan, population);
  Frame start, frame;
  make_frame(state, start);
  // Displaced from the lattice by a Gaussian of variance t per component, t since the start of the interval, anew at
  // every moment; at the start of an interval by nothing.
  const auto variance = [&](double t) { return t * 0.1; };
  while (correlator.next_sample() < std::numeric_limits<double>::infinity()) {
    frame = start;
    frame.time = correlator.next_sample();
    const double since = frame.time - plan.interval_length * std::floor(frame.time / plan.interval_length + 1e-9);
    const bool end = std::fabs(since) < 1e-9 && frame.time > 0;
    // The end of one interval is the start of the next: there the walk begins anew from where it has come to.
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const auto words = random_words(3, Stream::probe, i, std::bit_cast<std::uint64_t>(frame.time));
      const auto [x, y] = gaussian_pair(words[0], words[1]);
      const double sigma = std::sqrt(variance(end ? plan.interval_length : std::max(since, 0.0)));
      frame.x[i] += sigma * x, frame.y[i] += sigma * y;
    }
    if (end) start = frame;
    correlator.sample(frame);
  }
  const auto results = correlator.results();
  const auto& time = values(results, "/dynamics/all/overlap/time");
  const auto n = static_cast<double>(state.size());
  for (std::size_t lag = 0; lag < time.size(); ++lag) {
    CAPTURE(time[lag]);
    const double v = variance(time[lag]), q = 1 - std::exp(-0.25 / (2 * v));
    // 40 intervals of 672 disks: 26880 displacements. Six sigma for some fifty checks.
    const double sigma_q = std::sqrt(q * (1 - q) / (40 * n));
    CHECK(std::fabs(values(results, "/dynamics/all/overlap/value")[lag] - q) < 6 * sigma_q + 1e-12);
    // chi_4 = Q (1 - Q); a variance from 40 samples has a relative sigma of sqrt(2 / 39) = 0.23.
    const double chi = values(results, "/dynamics/all/susceptibility/value")[lag];
    CHECK(std::fabs(chi - q * (1 - q)) < 4.5 * 0.23 * q * (1 - q) + 2 / n);
  }
  // In the first interval, while the lattice is still one, a disk has six neighbours: MSD (1 + 1/6), and relative to
  // the centre of mass 1 - 1/N of it. Squares are exponential: 672 of them are right to 1/sqrt(672) = 4 %.
  const IntervalSeries cage = correlator.cage_relative_displacement(Group::all);
  for (std::size_t lag = 1; lag < cage.time.size(); ++lag)
    CHECK(std::fabs(cage.interval_mean(0, lag) / (2 * variance(cage.time[lag]) * 7 / 6) - 1) < 4.5 * 0.04);

  // The tenth of an exponential distribution of mean m that lies highest has the mean m (1 + ln 10), the lowest
  // 10 m (1 - 0.9 (1 - ln 0.9)). 40 * 67 disks; their sigma is at most that of an exponential tail, 1 / sqrt(2680).
  const double m = 2 * variance(plan.interval_length);
  const double fast = values(results, "/dynamics/all/mobility/fastest/value").back();
  const double slow = values(results, "/dynamics/all/mobility/slowest/value").back();
  CHECK(fast == doctest::Approx(m * (1 + std::log(10.0))).epsilon(0.03));
  CHECK(slow == doctest::Approx(m * 10 * (1 - 0.9 * (1 - std::log(0.9)))).epsilon(0.1));
  // What they did before is not remembered in this walk: both are as all.
  const double before = values(results, "/dynamics/all/mobility/fastest/value")[3];
  CHECK(before == doctest::Approx(2 * variance(time[3])).epsilon(6 / std::sqrt(2680.0)));

  // G_s(r, t) = exp(-r^2 / 2v) / (2 pi v), averaged over each ring; counts are binomial.
  const auto& g = values(results, "/dynamics/all/van_hove/value");
  const auto& edges = values(results, "/dynamics/all/van_hove/edges");
  const auto& lags = values(results, "/dynamics/all/van_hove/time");
  REQUIRE(lags.size() == 3);
  for (std::size_t i = 0; i < lags.size(); ++i) {
    const double v = variance(lags[i]);
    double total = 0;
    for (std::size_t bin = 0; bin < van_hove_bins; ++bin) {
      const double r1 = edges[bin] * edges[bin], r2 = edges[bin + 1] * edges[bin + 1];
      const double share = std::exp(-r1 / (2 * v)) - std::exp(-r2 / (2 * v));
      const double found = g[i * van_hove_bins + bin] * std::numbers::pi * (r2 - r1);
      total += found;
      CHECK(std::fabs(found - share) < 6 * std::sqrt(share / (40 * n)) + 6 / (40 * n));
    }
    CHECK(total == doctest::Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("a lattice that moves as a wave: neighbours move along, the cage-relative displacement is small") {
  const State state = lattice();
  const Population population = population_of(state);
  Frame frame;
  make_frame(state, frame);
  Snapshot origin, now;
  take_snapshot(frame, population, origin);
  // u_x = sin(k y) with k the longest wave of the box. The mean over six neighbours at distance d is
  // sin(k y) (1 + 2 (1 + 2 cos(k h)) ... ) / 6: two in the row, four at h above and below, so 1 - (2 + 4 cos(k h)) / 6.
  const double k = 2 * std::numbers::pi / length, h = length / rows;
  for (std::size_t i = 0; i < frame.size(); ++i) frame.x[i] += std::sin(k * frame.y[i]);
  take_snapshot(frame, population, now);
  const Cages cages = cages_of(origin, population);
  const RelativeDisplacements moved = relative_displacements(origin, now, cages);
  ExactSum square;
  add_squares(moved, population.range(Group::all), 1, square);
  // Six neighbours each (second ones are at 3.8; 1.5 contacts are 3.0, but 3.6 and 4.3 with big disks: rows of big
  // disks have second neighbours within 4.29 of each other).
  double by_hand = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    double x = now.x[i] - origin.x[i];
    double mean = 0;
    int count = 0;
    for (std::size_t j = 0; j < frame.size(); ++j) {
      double dx = origin.x[j] - origin.x[i], dy = origin.y[j] - origin.y[i];
      dx -= length * std::round(dx / length), dy -= length * std::round(dy / length);
      const double ri = i < population.small_count ? 1 : 1.43, rj = j < population.small_count ? 1 : 1.43;
      if (j == i || std::hypot(dx, dy) >= 1.5 * (ri + rj)) continue;
      mean += now.x[j] - origin.x[j], ++count;
    }
    x -= mean / count;
    by_hand += x * x;
  }
  CHECK(square.value() == doctest::Approx(by_hand).epsilon(1e-9));
  const double wave = 1 - (2 + 4 * std::cos(k * h)) / 6;
  CHECK(square.value() / static_cast<double>(frame.size()) < 4 * wave * wave);  // against 1/2 of the disks themselves
}
