#include "sandglass/observe/structure_sampler.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "sandglass/core/errors.h"
#include "sandglass/observe/scattered_disks.test.h"

using namespace sandglass;

namespace {

constexpr double length = 50;

State gas(std::uint64_t seed) {
  State state = scattered_disks(400, length, seed);
  draw_velocities(state, 1);
  return state;
}

MeasurementPlan plan_of(std::uint64_t frames) {
  MeasurementPlan plan;
  plan.start = 2, plan.interval_length = 5, plan.intervals = 4;
  plan.structure_frames = frames;
  return plan;
}

void feed(StructureSampler& sampler, std::uint64_t seed, std::uint64_t frames = 1000) {
  Frame frame;
  for (; frames > 0 && sampler.next_sample() < std::numeric_limits<double>::infinity(); --frames) {
    make_frame(gas(seed + std::bit_cast<std::uint64_t>(sampler.next_sample())), frame);
    sampler.sample(frame);
  }
}

const Dataset& find(const std::vector<Dataset>& results, const std::string& path) {
  for (const Dataset& d : results)
    if (d.path == path) return d;
  FAIL("no dataset " << path);
  throw;
}
const std::vector<double>& values(const std::vector<Dataset>& results, const std::string& path) {
  return std::get<std::vector<double>>(find(results, path).values);
}

bool same_bits(const std::vector<Dataset>& a, const std::vector<Dataset>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].path != b[i].path || a[i].shape != b[i].shape || a[i].values.index() != b[i].values.index()) return false;
    if (const auto* v = std::get_if<std::vector<double>>(&a[i].values)) {
      const auto& w = std::get<std::vector<double>>(b[i].values);
      for (std::size_t k = 0; k < v->size(); ++k)
        if (std::bit_cast<std::uint64_t>((*v)[k]) != std::bit_cast<std::uint64_t>(w[k])) return false;
    } else if (a[i].values != b[i].values) {
      return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("frames are spread evenly and fall into blocks of equally many") {
  const Population population = population_of(gas(1));
  StructureSampler sampler(plan_of(10), population);
  CHECK(sampler.frames() == 10);
  CHECK(sampler.next_sample() == doctest::Approx(3));  // the middle of the first tenth of 2 ... 22
  for (const std::uint64_t frames : {0, 1, 2, 4, 5, 19, 20, 23, 37, 100, 1001})
    CHECK(StructureSampler(plan_of(frames), population).frames() >= frames - frames / 10);
  CHECK(StructureSampler(plan_of(0), population).next_sample() == std::numeric_limits<double>::infinity());
  CHECK(StructureSampler(plan_of(0), population).results().empty());
}

TEST_CASE("an ideal gas has no structure, and the errors say how well that is known") {
  const Population population = population_of(gas(1));
  StructureSampler sampler(plan_of(20), population);
  feed(sampler, 5);
  const auto results = sampler.results();
  // Of some hundred values against their own errors from 20 blocks, Student's t with 19 degrees of freedom: beyond 6
  // once in 10^5; neighbouring bins of g(r) with few pairs are Poisson and skewed, so only bins with many pairs are
  // looked at.
  const auto check_one = [&](const std::string& path, const std::string& error_path, std::size_t from) {
    const auto &v = values(results, path), &e = values(results, error_path);
    for (std::size_t i = from; i < v.size(); ++i) {
      CAPTURE(path);
      CAPTURE(i);
      CHECK(std::fabs(v[i] - 1) < 6 * e[i]);
    }
  };
  for (const std::string pair : {"all", "small_small", "small_big", "big_big"})
    check_one("/structure/radial_distribution/" + pair, "/structure/radial_distribution/" + pair + "_error", 150);
  check_one("/structure/structure_factor/all/ring/value", "/structure/structure_factor/all/ring/error", 0);
  check_one("/structure/structure_factor/small/ring/value", "/structure/structure_factor/small/ring/error", 0);
  check_one("/structure/velocity/transverse/value", "/structure/velocity/transverse/error", 0);
  check_one("/structure/velocity/longitudinal/value", "/structure/velocity/longitudinal/error", 0);
  for (std::size_t pair = 0; pair < 3; ++pair) {
    const Estimate contact = sampler.contact_value(pair);
    CHECK(contact.error < 0.5);
    CHECK(std::fabs(contact.value - 1) < 6 * contact.error);
  }
  CHECK(sampler.global_bond_order().value < 0.1);  // 0.35 / sqrt(400) or so
  // Rings of ~100 vectors and 20 frames: noise 1 / sqrt(2000).
  CHECK(sampler.anisotropy(Group::small) < 0.2);
}

TEST_CASE("a triangular lattice: six neighbours, six sharp spots, bond order 1 near and far") {
  State state;
  // 24 x 28 disks: rows sqrt(3)/2 apart; a box that is square to 1 % would strain it, so the box is made to fit by a
  // slight stretch of rows, 24 / (28 * 0.866) = 0.99.
  state.box_length = 24 * 2.2;
  for (int row = 0; row < 28; ++row) {
    for (int column = 0; column < 24; ++column) {
      Disk& disk = state.disks.emplace_back();
      disk.x = 2.2 * (column + 0.5 * (row % 2));
      disk.y = state.box_length * row / 28;
    }
  }
  draw_velocities(state, 1);
  StructureSampler sampler(plan_of(2), population_of(state));
  Frame frame;
  make_frame(state, frame);
  sampler.sample(frame), sampler.sample(frame);
  const auto results = sampler.results();
  // The stretch of 1 % lowers psi_6 by about (3 * 0.01)^2.
  CHECK(sampler.global_bond_order().value > 0.995);
  CHECK(sampler.local_bond_order().value > 0.995);
  const auto& order = values(results, "/structure/bond_order/correlation/value");
  for (const double value : order)
    if (!std::isnan(value)) CHECK(value > 0.99);
  CHECK(std::isnan(order[0]));
  // All of S = N is in spots, six around the first ring.
  CHECK(sampler.anisotropy(Group::all) > 0.95);
  // Six neighbours at 2.2 (some at 2.19): integral of n g 2 pi r dr to 3.
  const auto& r = values(results, "/structure/radial_distribution/r");
  const auto& g = values(results, "/structure/radial_distribution/all");
  const double width = r[1] - r[0], n = 28.0 * 24.0;
  double neighbours = 0;
  for (std::size_t i = 0; i < r.size() && r[i] < 3; ++i)
    neighbours += g[i] * 2 * std::numbers::pi * r[i] * width * (n - 1) / (state.box_length * state.box_length);
  CHECK(neighbours == doctest::Approx(6).epsilon(1e-9));
}

TEST_CASE("stopped at any frame and resumed, the bits are the same") {
  const Population population = population_of(gas(1));
  StructureSampler whole(plan_of(6), population);
  feed(whole, 11);
  for (std::uint64_t cut = 0; cut <= 6; ++cut) {
    StructureSampler before(plan_of(6), population), after(plan_of(6), population);
    feed(before, 11, cut);
    auto from = before.fields(), to = after.fields();
    for (std::size_t i = 0; i < from.size(); ++i)
      std::visit([&](auto* source) { *std::get<decltype(source)>(to[i].target) = *source; }, from[i].target);
    feed(after, 11);
    CHECK(same_bits(whole.results(), after.results()));
  }
  const StructureSampler unfinished(plan_of(6), population);
  CHECK_THROWS_AS(whole.merge(unfinished), RunError);
}

TEST_CASE("merged runs weigh alike") {
  const Population population = population_of(gas(1));
  StructureSampler one(plan_of(6), population), two(plan_of(6), population);
  feed(one, 11);
  feed(two, 12);
  const std::string path = "/structure/structure_factor/all/ring/value";
  const auto a = values(one.results(), path), b = values(two.results(), path);
  one.merge(two);
  const auto both = values(one.results(), path);
  for (std::size_t i = 0; i < both.size(); ++i) CHECK(both[i] == doctest::Approx((a[i] + b[i]) / 2).epsilon(1e-12));
}
