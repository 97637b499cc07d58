#include "sandglass/core/state.h"

#include <bit>
#include <cmath>
#include <numbers>

#include "sandglass/core/frame.h"
#include "sandglass/core/random.h"

namespace sandglass {
namespace {

// 64-bit mixing hash over words; every step is invertible, so no single changed bit can go unseen.
class WordHash {
 public:
  void add(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0x9e3779b97f4a7c15u;
    hash_ ^= hash_ >> 29;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const ExactSum& sum) {
    add(static_cast<std::uint64_t>(sum.high()));
    add(sum.low());
  }
  [[nodiscard]] std::uint64_t value() const {
    std::uint64_t h = hash_ * 0xbf58476d1ce4e5b9u;
    h ^= h >> 32;
    return h * 0x94d049bb133111ebu ^ h >> 31;
  }

 private:
  std::uint64_t hash_ = 0x243f6a8885a308d3u;
};

}  // namespace

std::string state_hash(const State& state) {
  WordHash hash;
  hash.add(std::uint64_t{state.size()});
  hash.add(state.box_length);
  for (const double radius : state.mixture.radius) hash.add(radius);
  hash.add(state.seed);
  hash.add(state.drive.frequency);
  hash.add(state.drive.amplitude);
  hash.add(state.epoch_length);
  hash.add(state.epoch);
  hash.add(state.now);
  for (const Disk& disk : state.disks) {
    for (const double value : {disk.x, disk.y, disk.vx, disk.vy, disk.time, disk.last_contact, disk.next_kick})
      hash.add(value);
    hash.add(disk.kick_count);
    hash.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(disk.image_x)) << 32 |
             static_cast<std::uint32_t>(disk.image_y));
    hash.add(std::uint64_t{disk.species});
  }
  const Tally& tally = state.tally;
  for (const std::uint64_t count : tally.contacts) hash.add(count);
  for (const std::uint64_t count : tally.kicked) hash.add(count);
  for (const std::uint64_t count : {tally.elastic_contacts, tally.kicks, tally.kicks_without_partner, tally.transits})
    hash.add(count);
  for (const ExactSum& sum : {tally.virial, tally.dissipated, tally.injected}) hash.add(sum);

  constexpr char digits[] = "0123456789abcdef";
  std::string text(16, '0');
  std::uint64_t rest = hash.value();
  for (std::size_t i = 16; i-- > 0; rest >>= 4) text[i] = digits[rest & 15];
  return text;
}

double box_length_for(const Mixture& mixture, std::size_t small_count, std::size_t big_count, double packing_fraction) {
  const double squares = static_cast<double>(small_count) * mixture.radius[small] * mixture.radius[small] +
                         static_cast<double>(big_count) * mixture.radius[big] * mixture.radius[big];
  return std::sqrt(std::numbers::pi * squares / packing_fraction);
}

double packing_fraction(const State& state) {
  std::array<std::size_t, species_count> count{};
  for (const Disk& disk : state.disks) ++count[disk.species];
  const double unit_length = box_length_for(state.mixture, count[small], count[big], 1);
  return (unit_length / state.box_length) * (unit_length / state.box_length);
}

double minimum_box_length(const Mixture& mixture) {
  return 8 * (mixture.radius[small] > mixture.radius[big] ? mixture.radius[small] : mixture.radius[big]);
}

double kinetic_energy(const State& state) {
  ExactSum energy;
  for (const Disk& disk : state.disks)
    energy.add(0.5 * state.mixture.mass[disk.species] * (disk.vx * disk.vx + disk.vy * disk.vy));
  return energy.value();
}

std::array<double, 2> total_momentum(const State& state) {
  ExactSum px, py;
  for (const Disk& disk : state.disks) {
    px.add(state.mixture.mass[disk.species] * disk.vx);
    py.add(state.mixture.mass[disk.species] * disk.vy);
  }
  return {px.value(), py.value()};
}

Temperatures temperatures(const State& state) {
  double mass = 0;
  for (const Disk& disk : state.disks) mass += state.mixture.mass[disk.species];
  const auto [px, py] = total_momentum(state);
  const double ux = px / mass, uy = py / mass;
  std::array<ExactSum, species_count> energy;
  std::array<std::uint64_t, species_count> count{};
  for (const Disk& disk : state.disks) {
    const double wx = disk.vx - ux, wy = disk.vy - uy;
    energy[disk.species].add(0.5 * state.mixture.mass[disk.species] * (wx * wx + wy * wy));
    ++count[disk.species];
  }
  auto mean = [](double sum, std::uint64_t n) { return n ? sum / static_cast<double>(n) : 0.0; };
  ExactSum total = energy[small];
  total.add(energy[big]);
  return {mean(total.value(), state.size()), mean(energy[small].value(), count[small]),
          mean(energy[big].value(), count[big])};
}

void draw_velocities(State& state, double temperature) {
  double mass = 0;
  for (std::size_t id = 0; id < state.size(); ++id) {
    Disk& disk = state.disks[id];
    const auto words = random_words(state.seed, Stream::velocities, id, 0);
    const auto [gx, gy] = gaussian_pair(words[0], words[1]);
    const double width = std::sqrt(temperature / state.mixture.mass[disk.species]);
    disk.vx = width * gx;
    disk.vy = width * gy;
    mass += state.mixture.mass[disk.species];
  }
  const auto [px, py] = total_momentum(state);
  for (Disk& disk : state.disks) {
    disk.vx -= px / mass;
    disk.vy -= py / mass;
  }
  const double measured = temperatures(state).all;
  const double scale = measured > 0 ? std::sqrt(temperature / measured) : 0;
  for (Disk& disk : state.disks) {
    disk.vx *= scale;
    disk.vy *= scale;
  }
}

double clock_rate(const Drive& drive) {
  switch (drive.kind) {
    case DriveKind::pair:
      return drive.frequency / 2;
    case DriveKind::single:
      return drive.frequency;
    case DriveKind::none:
      break;
  }
  return 0;
}

void start_kick_clocks(State& state) {
  const double rate = clock_rate(state.drive);
  for (std::size_t id = 0; id < state.size(); ++id) {
    Disk& disk = state.disks[id];
    disk.kick_count = 0;
    disk.next_kick = rate > 0 ? state.now + exponential(random_words(state.seed, Stream::kicks, id, 0)[0]) / rate
                              : std::numeric_limits<double>::infinity();
  }
}

void change_drive(State& state, double frequency, double amplitude) {
  const double stretch = state.drive.frequency / frequency;
  for (Disk& disk : state.disks) disk.next_kick = state.now + (disk.next_kick - state.now) * stretch;
  state.drive.frequency = frequency;
  state.drive.amplitude = amplitude;
}

void make_frame(const State& state, Frame& frame) {
  frame.resize(state.size());
  frame.time = state.time();
  frame.collisions_per_disk = 2.0 * static_cast<double>(state.tally.collisions()) / static_cast<double>(state.size());
  for (std::size_t id = 0; id < state.size(); ++id) {
    const Disk& disk = state.disks[id];
    const double flight = state.now - disk.time;
    frame.x[id] = disk.x + disk.vx * flight + disk.image_x * state.box_length;
    frame.y[id] = disk.y + disk.vy * flight + disk.image_y * state.box_length;
    frame.vx[id] = disk.vx;
    frame.vy[id] = disk.vy;
  }
}

}  // namespace sandglass
