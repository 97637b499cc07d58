#include "sandglass/observe/scattering.h"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "sandglass/core/errors.h"
#include "sandglass/core/random.h"
#include "sandglass/observe/portable.h"

using namespace sandglass;

TEST_CASE("a shell has four to six directions close to the wanted wavenumber, whole under a quarter turn") {
  const bool ok = rc::check("shell", [] {
    const double box = *rc::gen::inRange(60, 4000) * 0.5;
    const double wanted = *rc::gen::inRange(50, 800) * 0.01;  // at least 2.4 units of 2 pi / L
    const WaveShell shell = wave_shell(wanted, box);
    RC_ASSERT(!shell.modes.empty() && shell.modes.size() <= 6);
    // The nearest two lengths are at most one unit 2 pi / L away: axis vectors alone give that.
    RC_ASSERT(std::fabs(shell.wavenumber - wanted) <= 2 * std::numbers::pi / box);
    double mean = 0;
    std::set<std::array<int, 2>> modes(shell.modes.begin(), shell.modes.end());
    RC_ASSERT(modes.size() == shell.modes.size());
    for (const auto& [m, n] : shell.modes) {
      mean += 2 * std::numbers::pi / box * std::hypot(m, n) / static_cast<double>(modes.size());
      RC_ASSERT(modes.contains({-m, -n}) == false);
      RC_ASSERT(modes.contains({-n, m}) || modes.contains({n, -m}));
    }
    RC_ASSERT(std::fabs(mean - shell.wavenumber) < 1e-12);
  });
  CHECK(ok);
  CHECK(wave_shell(3, 200).modes.size() >= 4);
  CHECK(wave_shell(0.1, 20).modes.size() == 2);  // longer than the box: (1, 0) and (0, 1), not a mixture
  CHECK(wave_shell(0.1, 20).wavenumber == doctest::Approx(2 * std::numbers::pi / 20));
  CHECK_THROWS_AS(wave_shell(0, 20), InputError);
  const WaveShell fine = wave_shell(1e4, 600);  // near the greatest number of waves
  CHECK(fine.modes.size() >= 4);
  CHECK(std::fabs(fine.wavenumber - 1e4) < 1e-5);  // lengths there are some units / 10^6 apart
  for (const double box : {1e6, 1e300, std::nan("")}) CHECK_THROWS_AS(wave_shell(1e4, box), InputError);
}

TEST_CASE("scattering of given displacements: equal to the plain loop bit by bit, and to the Gaussian law") {
  constexpr std::size_t n = 200000;
  constexpr double box = 100, width = 0.4;  // standard deviation of each component
  Snapshot origin, now;
  for (std::size_t i = 0; i < n; ++i) {
    const auto words = random_words(5, Stream::positions, i, 0);
    origin.x.push_back(box * uniform(words[0]));
    origin.y.push_back(box * uniform(words[1]));
    const auto [dx, dy] = gaussian_pair(words[2], words[3]);
    now.x.push_back(origin.x[i] + width * dx);
    now.y.push_back(origin.y[i] + width * dy);
  }
  const WaveShell shell = wave_shell(3, box);
  ExactSum sum;
  add_scattering(origin, now, {0, n}, shell, box, sum);

  // On a machine with wide vectors the function uses them; the plain loop must give the same bits.
  ExactSum plain;
  for (std::size_t begin = 0; begin < n; begin += block_size) {
    std::vector<double> cosines;
    for (std::size_t i = begin; i < std::min(n, begin + block_size); ++i) {
      const double dx = (now.x[i] - origin.x[i]) * (1 / box), dy = (now.y[i] - origin.y[i]) * (1 / box);
      double total = 0;
      for (const auto& [mx, my] : shell.modes) {
        const volatile double turns = mx * dx + my * dy;  // volatile: one at a time
        total += cosine_of_turns(turns);
      }
      cosines.push_back(total);
    }
    plain.add(1 / static_cast<double>(shell.modes.size()) * ordered_sum(cosines));
  }
  CHECK(sum == plain);

  // <cos k.dr> = exp(-k^2 width^2 / 2); MSD = 2 width^2. The variance of a cosine is at most 1/2, of the mean over
  // directions less: sigma < sqrt(0.5 / n) = 1.6e-3; five sigma.
  const double mean = sum.value() / static_cast<double>(n);
  CHECK(std::fabs(mean - std::exp(-shell.wavenumber * shell.wavenumber * width * width / 2)) < 5 * 1.6e-3);
  const auto gaussian = gaussian_approximation(shell, box, 2 * width * width);
  CHECK(std::fabs(gaussian.value - mean) < 5 * 1.6e-3);
  // The derivative, by a difference quotient with error of order h^2 k^6 / 64 / 6 = 2e-7 at h = 1e-3.
  const double up = gaussian_approximation(shell, box, 2 * width * width + 1e-3).value;
  const double down = gaussian_approximation(shell, box, 2 * width * width - 1e-3).value;
  CHECK(std::fabs(gaussian.derivative - (up - down) / 2e-3) < 2e-6);
}
