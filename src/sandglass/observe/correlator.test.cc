#include "sandglass/observe/correlator.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "sandglass/core/errors.h"
#include "sandglass/core/random.h"

using namespace sandglass;

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

// Every third disk is big, so that species are mixed along the ids.
Population mixed_population(std::size_t n, double box_length) {
  State state;
  state.box_length = box_length;
  state.disks.resize(n);
  for (std::size_t id = 0; id < n; ++id) state.disks[id].species = id % 3 == 1 ? big : small;
  return population_of(state);
}

// A frame that is a pure function of (time, seed) without any physics: what a comparison with brute force needs.
void noise_frame(double time, std::uint64_t seed, std::size_t n, Frame& frame) {
  frame.resize(n);
  frame.time = time;
  frame.collisions_per_disk = 40 * time;
  for (std::size_t id = 0; id < n; ++id) {
    const auto words = random_words(seed, Stream::probe, id, std::bit_cast<std::uint64_t>(time));
    const auto [x, y] = gaussian_pair(words[0], words[1]);
    const auto [vx, vy] = gaussian_pair(words[2], words[3]);
    frame.x[id] = 3 * x + time;
    frame.y[id] = 3 * y;
    frame.vx[id] = vx + 0.3;
    frame.vy[id] = vy;
  }
}

// Shows `observer` all frames it asks for, at most `limit` of them.
template <class Observer, class MakeFrame>
void feed(Observer& observer, MakeFrame&& make, int limit = std::numeric_limits<int>::max()) {
  Frame frame;
  for (int i = 0; i < limit && observer.next_sample() < endless; ++i) {
    make(observer.next_sample(), frame);
    observer.sample(frame);
  }
}

// Fields saved and restored by value, as a checkpoint does.
void copy_fields(std::vector<Field> from, std::vector<Field> to) {
  REQUIRE(from.size() == to.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    REQUIRE(from[i].name == to[i].name);
    std::visit([&](auto* source) { *std::get<decltype(source)>(to[i].target) = *source; }, from[i].target);
  }
}

bool same_bits(const std::vector<Dataset>& a, const std::vector<Dataset>& b) {
  auto words = [](const Dataset& d) {
    std::vector<std::uint64_t> bits;
    std::visit(
        [&](const auto& v) {
          for (const auto x : v) bits.push_back(std::bit_cast<std::uint64_t>(x));
        },
        d.values);
    return bits;
  };
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].path != b[i].path || a[i].shape != b[i].shape || words(a[i]) != words(b[i])) return false;
  }
  return true;
}

const std::vector<double>& values(const std::vector<Dataset>& results, const std::string& path) {
  for (const Dataset& d : results) {
    if (d.path == path) return std::get<std::vector<double>>(d.values);
  }
  FAIL("no dataset " << path);
  throw;
}

MeasurementPlan short_plan() {
  MeasurementPlan plan;
  plan.start = 3.7;
  plan.interval_length = 2.3;
  plan.intervals = 3;
  plan.shortest_lag = 0.011;
  plan.lags_per_decade = 4;
  plan.origins = 3;
  plan.wavenumbers = {0.9, 2.5};
  return plan;
}

}  // namespace

TEST_CASE("all quantities equal a brute-force evaluation on random frames") {
  const bool ok = rc::check("brute force", [] {
    MeasurementPlan plan = short_plan();
    plan.origins = *rc::gen::inRange<std::uint64_t>(1, 9);
    plan.lags_per_decade = *rc::gen::inRange(1, 9);
    plan.shortest_lag = 2.3 / *rc::gen::inRange(1, 2000);
    const auto n = *rc::gen::inRange<std::size_t>(3, 14);
    const auto seed = *rc::gen::arbitrary<std::uint64_t>();
    const Population population = mixed_population(n, 20);
    Correlator correlator(plan, population);
    feed(correlator, [&](double t, Frame& f) { noise_frame(t, seed, n, f); });

    const Schedule& schedule = correlator.schedule();
    auto mass = [&](std::size_t id) { return population.mixture.mass[id % 3 == 1 ? big : small]; };
    auto relative = [&](double t) {  // straight from the definition
      Frame frame;
      noise_frame(t, seed, n, frame);
      for (auto* c : {&frame.x, &frame.y, &frame.vx, &frame.vy}) {
        double moment = 0, total = 0;
        for (std::size_t id = 0; id < n; ++id) moment += mass(id) * (*c)[id], total += mass(id);
        for (double& value : *c) value -= moment / total;
      }
      return frame;
    };
    for (std::size_t interval = 0; interval < plan.intervals; ++interval) {
      const double start = 3.7 + static_cast<double>(interval) * 2.3;
      for (std::size_t lag = 0; lag < schedule.lags.size(); ++lag) {
        const std::uint64_t origins = schedule.level_of_lag[lag] == 0 ? 1 : plan.origins;
        double square = 0, fourth = 0, velocity = 0, velocity_displacement = 0, scattering = 0;
        for (std::uint64_t k = 0; k < origins; ++k) {
          const double offset = static_cast<double>(k) * 2.3 / static_cast<double>(plan.origins);
          const double later = lag + 1 == schedule.lags.size() ? plan.interval_start(interval + 1)
                                                               : start + (offset + schedule.lags[lag]);
          const Frame a = relative(start + offset), b = relative(later);
          for (std::size_t id = 1; id < n; id += 3) {  // the big ones
            const double dx = b.x[id] - a.x[id], dy = b.y[id] - a.y[id];
            square += dx * dx + dy * dy;
            fourth += (dx * dx + dy * dy) * (dx * dx + dy * dy);
            velocity += a.vx[id] * b.vx[id] + a.vy[id] * b.vy[id];
            velocity_displacement += a.vx[id] * dx + a.vy[id] * dy;
            // k = 2.5 in a box of 20: wanted 7.958 units; (8, 0), (0, 8) are nearest, then (5, 6) and (6, 5) with signs
            // at 7.810, 1.9 % away.
            const double unit = 2 * std::numbers::pi / 20;
            for (const auto& [m, q] : {std::array{8, 0}, {0, 8}, {5, 6}, {5, -6}, {6, 5}, {6, -5}})
              scattering += std::cos(unit * (m * dx + q * dy)) / 6;
          }
        }
        const double pairs = static_cast<double>((n + 1) / 3) * static_cast<double>(origins);
        // Rounding: a few terms of order 10^3 (fourth powers 10^5) with relative errors of 1e-15, and 1e-13 in a
        // cosine.
        auto close = [](double x, double y, double scale) { return std::fabs(x - y) < 1e-12 * scale; };
        RC_ASSERT(
            close(correlator.mean_square_displacement(Group::big).interval_mean(interval, lag), square / pairs, 1e3));
        RC_ASSERT(
            close(correlator.mean_fourth_displacement(Group::big).interval_mean(interval, lag), fourth / pairs, 1e5));
        RC_ASSERT(
            close(correlator.velocity_autocorrelation(Group::big).interval_mean(interval, lag), velocity / pairs, 1e2));
        RC_ASSERT(close(correlator.running_diffusion(Group::big).interval_mean(interval, lag),
                        velocity_displacement / (2 * pairs), 1e3));
        RC_ASSERT(close(correlator.self_intermediate_scattering(Group::big, 1).interval_mean(interval, lag),
                        scattering / pairs, 1));
      }
    }
  });
  CHECK(ok);
}

TEST_CASE("ballistic flight: MSD = <v^2> t^2, constant VACF, also in a box whose centre of mass moves") {
  const MeasurementPlan plan = short_plan();
  const std::size_t n = 50;
  const Population population = mixed_population(n, 20);
  Frame start;
  noise_frame(0, 8, n, start);
  Correlator correlator(plan, population);
  feed(correlator, [&](double t, Frame& f) {
    f = start;
    f.time = t;
    f.collisions_per_disk = 40 * t;
    for (std::size_t id = 0; id < n; ++id) {
      f.x[id] += start.vx[id] * t + t * t;  // the common acceleration must not be seen
      f.y[id] += start.vy[id] * t;
      f.vx[id] += 2 * t;
    }
  });
  const auto results = correlator.results();
  for (const std::string group : {"all", "small", "big"}) {
    const std::string path = "/dynamics/" + group;
    const auto& time = values(results, path + "/mean_square_displacement/time");
    const auto& square = values(results, path + "/mean_square_displacement/value");
    const auto& velocity = values(results, path + "/velocity_autocorrelation/value");
    const double equal_time = values(results, path + "/velocity_autocorrelation/equal_time_value")[0];
    for (std::size_t lag = 0; lag < time.size(); ++lag) {
      // Positions of order 100 are rounded to 1e-14, displacements at the shortest lag are 0.01: 1e-11 relative.
      CHECK(square[lag] == doctest::Approx(equal_time * time[lag] * time[lag]).epsilon(1e-10));
      CHECK(velocity[lag] == doctest::Approx(equal_time).epsilon(1e-12));
      CHECK(values(results, path + "/mean_square_displacement/collisions")[lag] ==
            doctest::Approx(40 * time[lag]).epsilon(1e-12));
    }
    CHECK(values(results, path + "/mean_square_displacement/error")[0] < 1e-10);
  }
  CHECK(correlator.collision_rate() == doctest::Approx(40).epsilon(1e-12));
}

TEST_CASE("Ornstein-Uhlenbeck velocities: MSD, VACF, S_inc and alpha_2 as derived") {
  // dv = -gamma v dt + noise, <v_x^2> = 1: VACF = 2 exp(-gamma t), MSD = (4 / gamma^2) (gamma t - 1 + exp(-gamma t)),
  // displacements are Gaussian: S = exp(-k^2 MSD / 4), alpha_2 = 0. Stepped exactly with the joint Gaussian of
  // (velocity, displacement) over a step [Uhlenbeck & Ornstein 1930].
  const double gamma = 1.3;
  const std::size_t n = 3000;
  MeasurementPlan plan = short_plan();
  plan.start = 0;
  plan.interval_length = 6;
  plan.intervals = 8;
  plan.lags_per_decade = 3;
  plan.origins = 2;
  const Population population = mixed_population(n, 50);
  Frame now;
  now.resize(n);
  std::uint64_t step = 0;
  auto gaussians = [&](std::size_t id, int part) {
    const auto words = random_words(11, Stream::probe, id, step);
    return part == 0 ? gaussian_pair(words[0], words[1]) : gaussian_pair(words[2], words[3]);
  };
  for (std::size_t id = 0; id < n; ++id) {
    const auto [gx, gy] = gaussians(id, 0);
    now.vx[id] = gx;
    now.vy[id] = gy;
  }
  Correlator correlator(plan, population);
  feed(correlator, [&](double t, Frame& f) {
    ++step;
    const double h = t - now.time, e = std::exp(-gamma * h);
    const double vv = 1 - e * e, vx = (1 - e) * (1 - e) / gamma;
    const double xx = (2 * gamma * h - 3 + 4 * e - e * e) / (gamma * gamma);
    const double a = std::sqrt(vv), b = vv > 0 ? vx / a : 0, c = std::sqrt(std::max(0.0, xx - b * b));
    for (std::size_t id = 0; h > 0 && id < n; ++id) {
      const auto [g1x, g1y] = gaussians(id, 0);
      const auto [g2x, g2y] = gaussians(id, 1);
      now.x[id] += now.vx[id] * (1 - e) / gamma + b * g1x + c * g2x;
      now.y[id] += now.vy[id] * (1 - e) / gamma + b * g1y + c * g2y;
      now.vx[id] = now.vx[id] * e + a * g1x;
      now.vy[id] = now.vy[id] * e + a * g1y;
    }
    now.time = t;
    f = now;
  });
  const auto results = correlator.results();
  const auto& time = values(results, "/dynamics/all/mean_square_displacement/time");
  const auto& square = values(results, "/dynamics/all/mean_square_displacement/value");
  const auto& velocity = values(results, "/dynamics/all/velocity_autocorrelation/value");
  const auto& running = values(results, "/dynamics/all/running_diffusion/value");
  const auto& alpha = values(results, "/dynamics/all/non_gaussian/value");
  const auto& scattered = values(results, "/dynamics/all/self_intermediate_scattering/value");
  const auto& gaussian = values(results, "/dynamics/all/gaussian_approximation/value");
  const auto& wavenumber = values(results, "/dynamics/all/self_intermediate_scattering/wavenumber");
  for (std::size_t lag = 0; lag < time.size(); ++lag) {
    // dr^2 of one disk is exponential (relative sigma 1); one origin per interval and disk, 24000 independent ones,
    // gives sigma = 6.5e-3. v(0).v(t) has a variance of at most that of v^2, 4: sigma = 2 / sqrt(24000) = 0.013.
    // alpha_2 from var(dr^4 / <dr^4>) = 5: about 0.5 sqrt(5 - 4 * 2 + 4 ...) < 2 / sqrt(24000) = 0.013. A cosine:
    // sqrt(1/2/24000) = 4.6e-3. Lags are correlated; 5 sigma for about 40 checks. The centre of mass takes 1/N = 3e-4,
    // well below.
    const double gt = gamma * time[lag];
    const double exact = 4 / (gamma * gamma) * (gt - 1 + std::exp(-gt));
    CHECK(std::fabs(square[lag] / exact - 1) < 5 * 6.5e-3);
    CHECK(std::fabs(velocity[lag] - 2 * std::exp(-gt)) < 5 * 0.013);
    // Half the integral of the VACF. v(0).dr / 2 has the variance (<v_x^2> <dx^2> + <v_x dx>^2) / 2 <= <dx^2> = exact /
    // 2 (Cauchy and Schwarz; two components).
    CHECK(std::fabs(running[lag] - (1 - std::exp(-gt)) / gamma) < 5 * std::sqrt(exact / 2 / 24000));
    CHECK(std::fabs(alpha[lag]) < 5 * 0.013);
    for (std::size_t k = 0; k < 2; ++k) {
      const double k2 = wavenumber[k] * wavenumber[k];
      // The shell's vectors differ by up to 5 % in |k|: <exp(-k^2 x)> is within var(k^2) x^2 / 2 < 1e-3 of exp(-<k>^2
      // x).
      CHECK(std::fabs(scattered[k * time.size() + lag] - std::exp(-k2 * exact / 4)) < 5 * 4.6e-3);
      CHECK(std::fabs(gaussian[k * time.size() + lag] - std::exp(-k2 * exact / 4)) < 5 * 4.6e-3);
    }
  }
  // The errors given must be of the size of the true ones: (longest lag, one origin per interval, eight intervals) the
  // standard error of 8 interval means has itself a relative sigma of 1/sqrt(14) = 0.27.
  const auto& error = values(results, "/dynamics/all/mean_square_displacement/error");
  CHECK(error.back() / square.back() == doctest::Approx(6.5e-3).epsilon(4 * 0.27));
  CHECK(error.back() / square.back() > 6.5e-3 / 4);
}

TEST_CASE("stopped at any sample and resumed, the bits are the same") {
  const MeasurementPlan plan = short_plan();
  const std::size_t n = 9;
  const Population population = mixed_population(n, 20);
  auto frames = [&](double t, Frame& f) { noise_frame(t, 77, n, f); };
  Correlator whole(plan, population);
  feed(whole, frames);
  const int samples = static_cast<int>(plan.intervals * (whole.schedule().frames() - 1)) + 1;
  int finished = 0;
  for (int cut = 0; cut <= samples; ++cut) {
    Correlator before(plan, population), after(plan, population);
    feed(before, frames, cut);
    copy_fields(before.fields(), after.fields());
    CHECK(std::bit_cast<std::uint64_t>(after.next_sample()) == std::bit_cast<std::uint64_t>(before.next_sample()));
    finished += after.next_sample() == endless;
    feed(after, frames);
    CHECK(same_bits(whole.results(), after.results()));
  }
  CHECK(finished == 1);  // the last cut alone: every sample counts
}

TEST_CASE("merging adds the intervals of an independent run") {
  const MeasurementPlan plan = short_plan();
  const std::size_t n = 9;
  const Population population = mixed_population(n, 20);
  Correlator one(plan, population), two(plan, population);
  feed(one, [&](double t, Frame& f) { noise_frame(t, 1, n, f); });
  feed(two, [&](double t, Frame& f) { noise_frame(t, 2, n, f); });
  const IntervalSeries a = one.mean_square_displacement(Group::all), b = two.mean_square_displacement(Group::all);
  const auto first = one.results(), second = two.results();
  one.merge(two);
  const auto merged = one.results();
  for (const char* name : {"/dynamics/small/van_hove/value", "/dynamics/big/mobility/fastest/value",
                           "/dynamics/all/cage_relative_displacement/value", "/dynamics/all/overlap/value"}) {
    const auto &x = values(first, name), &y = values(second, name), &z = values(merged, name);
    for (std::size_t i = 0; i < z.size(); ++i) CHECK(z[i] == doctest::Approx((x[i] + y[i]) / 2).epsilon(1e-12));
  }
  const IntervalSeries both = one.mean_square_displacement(Group::all);
  REQUIRE(both.intervals == 6);
  for (std::size_t lag = 0; lag < both.time.size(); ++lag) {
    CHECK(both.mean(lag) == doctest::Approx((a.mean(lag) + b.mean(lag)) / 2).epsilon(1e-12));
    CHECK(both.interval_mean(4, lag) == b.interval_mean(1, lag));
  }
  CHECK(one.collision_rate() == doctest::Approx(40).epsilon(1e-12));
  MeasurementPlan other = plan;
  other.origins = 2;
  CHECK_THROWS_AS(one.merge(Correlator(other, population)), RunError);
}

TEST_CASE("another observer beside it changes nothing") {
  // An engine whose frames depend on the time alone; what is tested is that shared frames and shared moments of two
  // schedules do not disturb each other.
  struct Engine {
    double now = 0;
    void run_until(double end) { now = end > now ? end : now; }
    void make_frame(Frame& frame) const { noise_frame(now, 5, 9, frame); }
  };
  const MeasurementPlan plan = short_plan();
  MeasurementPlan denser = plan;
  denser.lags_per_decade = 7;
  denser.interval_length = plan.interval_length / 2;
  const Population population = mixed_population(9, 20);
  Correlator alone(plan, population), together(plan, population), beside(denser, population);
  Frame frame;
  Engine first, second;
  run_until(first, plan.end(), frame, alone);
  run_until(second, plan.end() / 2, frame, together, beside);
  run_until(second, plan.end(), frame, together, beside);
  CHECK(alone.next_sample() == endless);
  CHECK(same_bits(alone.results(), together.results()));
}

TEST_CASE("one species alone: results of the empty one are left out") {
  State state;
  state.box_length = 20;
  state.disks.resize(5);
  Correlator correlator(short_plan(), population_of(state));
  feed(correlator, [&](double t, Frame& f) { noise_frame(t, 1, 5, f); });
  for (const Dataset& d : correlator.results()) CHECK(d.path.find("/big/") == std::string::npos);
}
