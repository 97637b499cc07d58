#include "sandglass/observe/bond_order.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sandglass/observe/scattered_disks.test.h"

using namespace sandglass;

namespace {

struct System {
  Frame frame;
  Population population;
};

System system_of(const State& state) {
  System system{{}, population_of(state)};
  make_frame(state, system.frame);
  return system;
}

System random_binary(std::size_t n, double box_length, std::uint64_t seed) {
  return system_of(scattered_disks(n, box_length, seed));
}

}  // namespace

TEST_CASE("a triangular lattice has psi_6 = 1, a square one 0") {
  State triangular;
  triangular.box_length = 60;
  const int columns = 26, rows = 30;  // rows / columns is 2 / sqrt 3 to 8e-4: fits a square box
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      Disk disk;
      disk.x = 60.0 / columns * (i + 0.5 * (j % 2) + 0.1);
      disk.y = 60.0 / rows * (j + 0.1);
      triangular.disks.push_back(disk);
    }
  }
  const System lattice = system_of(triangular);
  const auto psi = bond_order(lattice.frame, lattice.population);
  // The strain of 8e-4 has two-fold symmetry, so it enters six-fold order in second order: about 36 (8e-4)^2 = 2e-5.
  for (const auto& value : psi) CHECK(std::fabs(value.real() - 1) < 1e-4);
  CHECK(global_bond_order(psi) > 0.9999);

  State square;
  square.box_length = 30;
  for (int i = 0; i < 100; ++i) {
    Disk disk;
    disk.x = 3 * (i % 10);
    disk.y = 3 * (i / 10);
    square.disks.push_back(disk);
  }
  const System other = system_of(square);
  // 1 - 1 + 1 - 1 over the four sides; the corners have no length up to rounding.
  for (const auto& value : bond_order(other.frame, other.population)) CHECK(std::abs(value) < 1e-9);
}

TEST_CASE("turning the lattice turns psi_6 by six times the angle") {
  // A patch of triangular lattice turned by 10 degrees, in a box so wide that its middle sees no border.
  State state;
  state.box_length = 200;
  const double angle = std::numbers::pi / 18;
  for (int j = -12; j <= 12; ++j) {
    for (int i = -12; i <= 12; ++i) {
      const double x = 2.2 * (i + 0.5 * j), y = 2.2 * std::sqrt(0.75) * j;
      Disk disk;
      disk.x = 100 + x * std::cos(angle) - y * std::sin(angle);
      disk.y = 100 + x * std::sin(angle) + y * std::cos(angle);
      state.disks.push_back(disk);
    }
  }
  const System patch = system_of(state);
  const auto psi = bond_order(patch.frame, patch.population);
  CHECK(std::abs(psi[12 * 25 + 12] - std::polar(1.0, 6 * angle)) < 1e-9);
}

TEST_CASE("cells of a random binary system, side by side against brute force") {
  // Independent algorithm: the line between i and j is cut to an interval by the half planes of all others.
  for (const std::uint64_t seed : {1, 2, 3}) {
    for (const double box : {14.0, 80.0}) {  // crowded (overlapping points) and dilute
      const System system = random_binary(60, box, seed);
      const auto psi = bond_order(system.frame, system.population);
      std::vector<double> radius(60);
      for (std::size_t i = 0; i < 60; ++i)
        radius[system.population.order[i]] = i < system.population.small_count ? 1.0 : 1.43;
      struct Plane {
        double nx, ny, h;
      };
      for (std::size_t i = 0; i < 60; ++i) {
        std::vector<Plane> planes{{1, 0, box / 2}, {-1, 0, box / 2}, {0, 1, box / 2}, {0, -1, box / 2}};
        for (std::size_t j = 0; j < 60; ++j) {
          if (j == i) continue;
          double dx = system.frame.x[j] - system.frame.x[i], dy = system.frame.y[j] - system.frame.y[i];
          dx -= box * std::round(dx / box);
          dy -= box * std::round(dy / box);
          const double d = std::hypot(dx, dy);
          planes.push_back({dx / d, dy / d, (d * d + radius[i] * radius[i] - radius[j] * radius[j]) / (2 * d)});
        }
        std::complex<double> sum = 0;
        double perimeter = 0;
        for (std::size_t p = 4; p < planes.size(); ++p) {
          double low = -1e9, high = 1e9;  // along the line h n + s (-ny, nx)
          for (std::size_t q = 0; q < planes.size(); ++q) {
            if (q == p) continue;
            const Plane &a = planes[p], &b = planes[q];
            const double slope = -b.nx * a.ny + b.ny * a.nx, room = b.h - a.h * (a.nx * b.nx + a.ny * b.ny);
            if (slope > 0) high = std::min(high, room / slope);
            if (slope < 0) low = std::max(low, room / slope);
          }
          const double length = std::max(0.0, high - low);
          sum += length * std::polar(1.0, 6 * std::atan2(planes[p].ny, planes[p].nx));
          perimeter += length;
        }
        const std::complex<double> expected = perimeter > 0 ? sum / perimeter : 0;
        CHECK(std::abs(psi[i] - expected) < 1e-9);
      }
    }
  }
}

TEST_CASE("random points have no global order") {
  const System gas = random_binary(4000, 150, 7);
  // |psi_6| of one disk is below 1; the mean of 4000 random phases has sigma < 1 / sqrt(4000) = 0.016.
  CHECK(global_bond_order(bond_order(gas.frame, gas.population)) < 5 * 0.016);
}
