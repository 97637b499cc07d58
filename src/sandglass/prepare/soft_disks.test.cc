#include "sandglass/prepare/soft_disks.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numbers>

#include "sandglass/core/random.h"
#include "sandglass/prepare/periodic.h"

using namespace sandglass;

namespace {

std::vector<SoftDisk> random_soft_disks(std::size_t count, double box_length, std::uint64_t seed) {
  std::vector<SoftDisk> disks(count);
  for (std::size_t id = 0; id < count; ++id) {
    const auto words = random_words(seed, Stream::positions, id, 0);
    SoftDisk& disk = disks[id];
    disk.x = box_length * uniform(words[0]), disk.y = box_length * uniform(words[1]);
    disk.vx = 2 * uniform(words[2]) - 1, disk.vy = 2 * uniform(words[3]) - 1;
    disk.radius = id % 2 ? 1.43 : 1.0;
    disk.inverse_mass = 1 / (disk.radius * disk.radius);
  }
  return disks;
}

/// The same dynamics without cells or lists.
void step_all_pairs(std::vector<SoftDisk>& disks, double box, double swelling) {
  for (SoftDisk& disk : disks) {
    disk.vx += SoftDisks::time_step * disk.inverse_mass * disk.fx;
    disk.vy += SoftDisks::time_step * disk.inverse_mass * disk.fy;
    disk.x = wrapped(disk.x + SoftDisks::time_step * disk.vx, box);
    disk.y = wrapped(disk.y + SoftDisks::time_step * disk.vy, box);
    disk.fx = disk.fy = 0;
  }
  for (SoftDisk& a : disks) {
    for (SoftDisk& b : disks) {
      const double dx = nearest_image(a.x - b.x, box), dy = nearest_image(a.y - b.y, box);
      const double r = std::hypot(dx, dy), overlap = swelling * (a.radius + b.radius) - r;
      if (&a == &b || overlap <= 0) continue;
      const double speed = ((a.vx - b.vx) * dx + (a.vy - b.vy) * dy) / r;
      const double force = SoftDisks::stiffness * overlap - SoftDisks::dashpot * speed;
      a.fx += force * dx / r, a.fy += force * dy / r;
    }
  }
}

}  // namespace

TEST_CASE("cells and lists leave out no pair") {
  // Rounding differences of 1e-16 grow by the chaos of 60 steps, in which a disk meets about five others, by some ten
  // each: below 1e-9. A pair left out for one step moves disks by about 0.25^2 * overlap, a million times more.
  CHECK(rc::check([] {
    const double box_length = 10.1 + 0.1 * *rc::gen::inRange(0, 200);
    const auto count = static_cast<std::size_t>(0.18 * box_length * box_length);
    auto plain = random_soft_disks(count, box_length, *rc::gen::arbitrary<std::uint32_t>());
    SoftDisks disks(box_length, plain);
    for (int step = 0; step < 60; ++step) {
      const double swelling = 0.8 + step / 400.0;
      disks.step(swelling);
      step_all_pairs(plain, box_length, swelling);
    }
    for (std::size_t slot = 0; slot < count; ++slot) {
      const SoftDisk &a = disks.disks()[slot], &b = plain[disks.ids()[slot]];
      RC_ASSERT(a.radius == b.radius);
      RC_ASSERT(std::fabs(nearest_image(a.x - b.x, box_length)) < 1e-9);
      RC_ASSERT(std::fabs(nearest_image(a.y - b.y, box_length)) < 1e-9);
    }
  }));
}

TEST_CASE("two soft disks part with the restitution of a damped spring") {
  // e = exp(-pi eta / omega), eta = gamma / (2 m), omega = sqrt(k / m - eta^2), contact ending at r = s. The dashpot
  // sees the velocity half a step before, v - a dt / 2, which acts like the mass m = mu - gamma dt / 2. One collision
  // depends on where in a time step it begins; the mean over 64 phases leaves errors of order (omega dt)^2 / 10 =
  // 0.012.
  const double mass = 0.5 - SoftDisks::dashpot * SoftDisks::time_step / 2, damping = SoftDisks::dashpot / (2 * mass);
  const double omega = std::sqrt(SoftDisks::stiffness / mass - damping * damping);
  const double expected = std::exp(-std::numbers::pi * damping / omega);
  double restitution = 0;
  for (int phase = 0; phase < 64; ++phase) {
    std::vector<SoftDisk> pair(2);
    pair[0] = {.x = 19.5, .y = 3, .vx = 0.1, .vy = 0.3, .radius = 1, .inverse_mass = 1};
    pair[1] = {.x = 2 + (phase + 0.5) * 0.2 * SoftDisks::time_step / 64, .y = 3, .vx = -0.1, .vy = 0.3};
    pair[1].radius = pair[1].inverse_mass = 1;
    SoftDisks disks(20, pair);
    for (int step = 0; step < 100; ++step) disks.step(1);
    const SoftDisk& a = disks.disks()[0];
    const SoftDisk& b = disks.disks()[1];
    CHECK(std::fabs(a.vx + b.vx) < 1e-14);  // momentum: equal and opposite forces, rounded a few times
    CHECK((a.vy == 0.3 && b.vy == 0.3));    // no force across the line of centres
    CHECK(disks.deepest_overlap() == 0);
    restitution += std::fabs(a.vx - b.vx) / 0.2 / 64;
  }
  CHECK(std::fabs(restitution - expected) < 0.012);
}

TEST_CASE("disks at one point and disks out of reach feel no force") {
  std::vector<SoftDisk> disks(3);
  for (SoftDisk& disk : disks) disk = {.x = 5, .y = 5, .radius = 1, .inverse_mass = 1};
  disks[2].x = 7.01;
  SoftDisks soft(20, disks);
  for (int step = 0; step < 10; ++step) soft.step(1);
  for (std::size_t slot = 0; slot < 3; ++slot) {
    CHECK(soft.disks()[slot].x == disks[soft.ids()[slot]].x);
    CHECK(soft.disks()[slot].y == 5);
  }
  CHECK(soft.deepest_overlap() == 1);
}
