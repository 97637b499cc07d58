// Elastic disks in equilibrium: pressure and collision rates against the virial series, the mixture formulas, and each
// other.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "sandglass/prepare/grid.h"
#include "sandglass/prepare/periodic.h"
#include "setup.h"

using namespace sandglass;
using namespace sandglass::physics;

namespace {

constexpr std::size_t particles = 2000;
constexpr double count = particles;

/// Relative error of the mixture formulas: 1.1 % at eta = 0.5 and 2 % at 0.6 at most; it starts with the fourth virial
/// coefficient, so with the third power of the density. 1/N for what a finite number of disks changes.
double formula_error(double eta) { return 0.02 * std::pow(eta / 0.6, 3) + 1 / count; }

void check_state_point(double size_ratio, double eta, std::uint64_t seed) {
  CAPTURE(size_ratio);
  CAPTURE(eta);
  const Mixture mixture = mixture_of(size_ratio);
  const auto expected = collision_rates(mixture, 0.5, eta, {1, 1});
  Simulation simulation(start(size_ratio, particles, eta, seed));
  simulation.run_until(100 / expected.mean);

  // 40 blocks of 25 collisions per disk: 10^6 collisions. The pressure is then known to about 0.15 %.
  Average excess, relation, rate;
  std::array<std::array<Average, 2>, 2> pair;
  for (int block = 0; block < block_count; ++block) {
    const Stretch seen = run_stretch(simulation, 25 / expected.mean);
    // With the total momentum at rest the relative motion is hotter than T by N/(N-1), and so is the excess pressure.
    excess.add(seen.virial * (count - 1) / count);
    const double from_rates = compressibility_from_rates(mixture, 0.5, seen.rates, {1, 1}) - 1;
    relation.add(seen.virial / from_rates);
    rate.add(seen.rate);
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) pair[i][j].add(seen.rates[i][j] / expected.pair[i][j]);
  }

  const double formula = compressibility_factor(mixture, 0.5, eta) - 1;
  CHECK(excess.error() < 0.004 * formula);  // else the checks below would be idle
  CHECK(excess.sigmas_from(formula, formula_error(eta) * formula) < allowed_sigmas);
  CHECK(rate.sigmas_from(expected.mean, formula_error(eta) * expected.mean) < allowed_sigmas);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) CHECK(pair[i][j].sigmas_from(1, formula_error(eta)) < allowed_sigmas);
  // One size: the Pade approximant is exact here to 2e-4; in N disks Z is lower by (eta Z)'' eta / (2 N (eta Z)'),
  // less than (Z - 1) / N.
  if (size_ratio == 1) {
    const double pade = virial_pade(eta) - 1;
    CHECK(excess.sigmas_from(pade, (2e-4 + 1 / count) * pade) < allowed_sigmas);
  }
  // Exact at any density: impulses are sqrt(pi mu T / 2) (1 + eps) on average. Virial and rates share their
  // fluctuations; one impulse scatters by 52 %, so that their ratio is known to 5e-4. It goes as the square root of
  // the temperature of relative motion.
  CHECK(relation.error() < 0.001);
  CHECK(relation.sigmas_from(std::sqrt(count / (count - 1))) < allowed_sigmas);
}

/// Ordered pairs of species found in thin rings around contact; gives the density of j at contact with i.
class ContactDensity {
 public:
  static constexpr int bins = 8;
  static constexpr double width = 0.01;  ///< of a bin, in units of R_i + R_j

  explicit ContactDensity(const State& state) : state_(state) {}

  void add(const Frame& frame) {
    const double length = state_.box_length;
    Grid grid(length, 2 * state_.mixture.radius[big] * (1 + bins * width), frame.size());
    for (std::uint32_t id = 0; id < frame.size(); ++id) {
      const double x = wrapped(frame.x[id], length), y = wrapped(frame.y[id], length);
      const Species species = state_.disks[id].species;
      grid.visit_near(x, y, [&](std::uint32_t other) {
        const Species partner = state_.disks[other].species;
        const double contact = state_.mixture.radius[species] + state_.mixture.radius[partner];
        const double dx = nearest_image(wrapped(frame.x[other], length) - x, length);
        const double dy = nearest_image(wrapped(frame.y[other], length) - y, length);
        const auto bin = static_cast<int>((std::sqrt(dx * dx + dy * dy) / contact - 1) / width);
        if (bin >= 0 && bin < bins) {
          pairs_[species][partner][bin] += 1;
          pairs_[partner][species][bin] += 1;
        }
        return true;
      });
      grid.add(id, x, y);
    }
    frames_ += 1;
  }

  /// Density of species j at contact with a disk of species i: the least-squares parabola through the eight rings,
  /// taken at the edge u = -4 of the first; u = -7/2 ... 7/2 are the ring centres, sum u^2 = 42, sum u^4 = 388.5.
  [[nodiscard]] double at_contact(int i, int j) const {
    const double contact = state_.mixture.radius[i] + state_.mixture.radius[j];
    const double half = static_cast<double>(state_.size()) / 2;
    double density = 0;
    for (int bin = 0; bin < bins; ++bin) {
      const double u = bin - 3.5;
      const double weight = -4 * u / 42 + (86 * u * u - 283.5) / (8 * 388.5 - 42 * 42);
      const double inner = contact * (1 + bin * width), outer = inner + contact * width;
      density += weight * pairs_[i][j][bin] / (frames_ * half * std::numbers::pi * (outer * outer - inner * inner));
    }
    return density;
  }

 private:
  const State& state_;
  double frames_ = 0;
  std::array<std::array<std::array<double, bins>, 2>, 2> pairs_{};
};

}  // namespace

TEST_CASE("pressure and collision rates of disks of one size") {
  for (const double eta : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}) check_state_point(1, eta, 11);
}

TEST_CASE("pressure and collision rates of the mixture") {
  for (const double eta : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}) check_state_point(1.43, eta, 12);
}

TEST_CASE("disks collide as often as g(r) at contact says") {
  const double eta = 0.5, free_time = mean_free_time(mixture_of(1.43), 0.5, eta, 1);
  const State initial = start(1.43, particles, eta, 13);
  const auto& mass = initial.mixture.mass;
  Simulation simulation(initial);
  simulation.run_until(100 * free_time);

  // 40 blocks of 100 frames half a collision apart: 10^5 pairs of small disks per ring in all, which makes 0.35 %.
  std::array<std::array<Average, 2>, 2> ratio;
  for (int block = 0; block < block_count; ++block) {
    ContactDensity contacts(initial);
    Frame frame;
    const Stretch seen = run_stretch(simulation, 50 * free_time, 100, [&] {
      simulation.make_frame(frame);
      contacts.add(frame);
    });
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        // omega_ij = sqrt(2 pi) s_ij sqrt(theta) times the density of j at contact.
        const double theta = (1 / mass[i] + 1 / mass[j]) * count / (count - 1);
        const double contact = initial.mixture.radius[i] + initial.mixture.radius[j];
        ratio[i][j].add(seen.rates[i][j] /
                        (std::sqrt(2 * std::numbers::pi * theta) * contact * contacts.at_contact(i, j)));
      }
  }
  // A parabola over h = 8 % of the distance leaves out about h^3 / 120 times the third derivative, some 400 g: 0.2 %.
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      CAPTURE(i);
      CAPTURE(j);
      CHECK(ratio[i][j].error() < 0.006);
      CHECK(ratio[i][j].sigmas_from(1, 0.003) < allowed_sigmas);
    }
}
