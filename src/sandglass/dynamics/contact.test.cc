#include "sandglass/dynamics/contact.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <cmath>

#include "sandglass/core/random.h"

using namespace sandglass;

namespace {

Disk random_disk(std::uint64_t seed, std::uint64_t id, double length) {
  const auto a = random_words(seed, Stream::probe, id, 0), b = random_words(seed, Stream::probe, id, 1);
  Disk disk;
  disk.x = uniform(a[0]) * length;
  disk.y = uniform(a[1]) * length;
  disk.vx = gaussian_pair(b[0], b[1])[0];
  disk.vy = gaussian_pair(b[0], b[1])[1];
  disk.time = uniform(a[2]);
  return disk;
}

}  // namespace

TEST_CASE("at the predicted time the disks are at contact distance, approaching, and were apart before") {
  const Box box(20, {});
  int contacts = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Disk a = random_disk(3, 2 * i, 20), b = random_disk(3, 2 * i + 1, 20);
    const double contact = 2.43;
    const double t = contact_time(a, b, contact, box);
    CHECK(t == contact_time(b, a, contact, box));  // to the last bit
    if (std::isinf(t)) continue;
    const double reference = std::fmax(a.time, b.time);
    if (surface_gap(a, b, contact, reference, box) < 0 || t - reference > 3) continue;  // stay near the nearest image
    ++contacts;
    // Rounding: positions to 4e-15 (L = 20), magnified by relative to normal speed at grazing incidence.
    CHECK(std::fabs(surface_gap(a, b, contact, t, box)) < 1e-9);
    for (int n = 1; n < 10; ++n) CHECK(surface_gap(a, b, contact, reference + (t - reference) * n / 10, box) > -1e-12);
  }
  CHECK(contacts > 500);
}

TEST_CASE("a collision keeps momentum, reverses the normal velocity times eps, loses the stated energy") {
  const Box box(20, {});
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Disk a = random_disk(4, 2 * i, 20), b = random_disk(4, 2 * i + 1, 20);
    a.time = b.time = 1;
    const double ma = 1 + uniform(random_words(1, Stream::probe, i, 0)[0]), mb = 1.7,
                 eps = 0.1 + 0.9 * uniform(i << 40);
    const Separation r = separation_at(a, b, 1, box);
    const double distance = std::sqrt(r.x * r.x + r.y * r.y);
    const auto normal = [&] { return (r.x * (b.vx - a.vx) + r.y * (b.vy - a.vy)) / distance; };
    const auto tangential = [&] { return (r.x * (b.vy - a.vy) - r.y * (b.vx - a.vx)) / distance; };
    const auto energy = [&] { return 0.5 * ma * (a.vx * a.vx + a.vy * a.vy) + 0.5 * mb * (b.vx * b.vx + b.vy * b.vy); };
    if (normal() > 0) continue;
    const double before = normal(), along = tangential(), e = energy(), px = ma * a.vx + mb * b.vx;
    const Impact impact = collide(a, b, PairMasses(ma, mb), eps, box);
    // A dozen roundings of numbers of order 1 to 10.
    CHECK(normal() == doctest::Approx(-eps * before).epsilon(1e-12).scale(1e-2));
    CHECK(tangential() == doctest::Approx(along).epsilon(1e-12).scale(1e-2));
    CHECK(ma * a.vx + mb * b.vx == doctest::Approx(px).epsilon(1e-12).scale(1e-2));
    CHECK(e - energy() == doctest::Approx(impact.dissipated).epsilon(1e-12).scale(1e-2));
    CHECK(impact.virial == doctest::Approx(-ma * mb / (ma + mb) * (1 + eps) * before * distance).epsilon(1e-12));
  }
}

TEST_CASE("after any collision, however grazing, the pair recedes and is not predicted again") {
  const Box box(20, {});
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const auto words = random_words(9, Stream::probe, i, 0);
    const double angle = uniform(words[0]);
    const auto [sine, cosine] = portable_sincos_turns(angle);
    Disk a, b;
    a.x = a.y = 10;
    b.x = 10 + 2.0 * cosine;
    b.y = 10 + 2.0 * sine;
    // Relative motion almost tangential, with a normal part from 1e-10 down to below rounding; a common drift on top.
    const double graze = std::pow(10.0, -10 - 9 * uniform(words[1]));
    a.vx = 3;
    b.vx = 3 - sine - graze * cosine;
    b.vy = cosine - graze * sine;
    collide(a, b, PairMasses(1, 1), 0.5, box);
    CHECK(std::isinf(contact_time(a, b, 2.0, box)));
    CHECK(std::isinf(contact_time(b, a, 2.0, box)));
  }
}

TEST_CASE("advancing wraps into [0, L) and counts images") {
  const Box box(10, {});
  Disk disk;
  disk.x = 9;
  disk.y = 1e-18;
  disk.vx = 2;
  disk.vy = -1e-17;
  advance(disk, disk.image_x, disk.image_y, 1, box);
  CHECK(disk.x == 1);
  CHECK(disk.image_x == 1);
  CHECK(disk.y >= 0);
  CHECK(disk.y < 10);
  CHECK(disk.image_y == 0);
}
