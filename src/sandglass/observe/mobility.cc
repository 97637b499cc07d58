#include "sandglass/observe/mobility.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "sandglass/observe/msd.h"

namespace sandglass {

Mobility::Mobility(std::vector<double> lags, std::size_t selection, const Population& population,
                   std::uint64_t intervals)
    : lags_(std::move(lags)), selection_(selection) {
  const std::size_t step = (population.size() + most_followed - 1) / most_followed;
  for (std::size_t i = 0; i < population.size(); i += step) {
    followed_.push_back(static_cast<std::uint32_t>(i));
    small_followed_ += i < population.small_count;
  }
  squares_.resize(lags_.size() * followed_.size());
  sums_.resize(intervals * lags_.size() * groups.size() * 2);
}

void Mobility::add(std::size_t lag, const Snapshot& origin, const Snapshot& now) {
  const double scale = displacement_scale(lags_[lag]);
  double* squares = &squares_[lag * followed_.size()];
  for (std::size_t f = 0; f < followed_.size(); ++f) {
    const std::uint32_t i = followed_[f];
    const double dx = (now.x[i] - origin.x[i]) * scale, dy = (now.y[i] - origin.y[i]) * scale;
    squares[f] = dx * dx + dy * dy;
  }
}

void Mobility::finish(std::uint64_t interval) {
  for (const Group group : groups)
    if (chosen(group) > 0) choose(interval, group);
}

std::size_t Mobility::chosen(Group group) const {
  const std::size_t big_followed = followed_.size() - small_followed_;
  const std::size_t disks = group == Group::all     ? followed_.size()
                            : group == Group::small ? small_followed_
                                                    : big_followed;
  return disks == 0 ? 0 : std::max<std::size_t>(1, disks / 10);
}

void Mobility::choose(std::uint64_t interval, Group group) {
  std::vector<std::size_t> disks(followed_.size());
  std::iota(disks.begin(), disks.end(), 0);
  if (group == Group::small) disks.resize(small_followed_);
  if (group == Group::big) disks.erase(disks.begin(), disks.begin() + static_cast<std::ptrdiff_t>(small_followed_));
  const double* selecting = &squares_[selection_ * followed_.size()];
  const auto slower = [&](std::size_t a, std::size_t b) {
    return selecting[a] != selecting[b] ? selecting[a] < selecting[b] : a < b;
  };
  const std::size_t count = chosen(group);
  for (const Tail tail : {fastest, slowest}) {
    const std::size_t place = tail == slowest ? count : disks.size() - count;
    std::nth_element(disks.begin(), disks.begin() + static_cast<std::ptrdiff_t>(std::min(place, disks.size() - 1)),
                     disks.end(), slower);
    const std::size_t begin = tail == slowest ? 0 : place;
    for (std::size_t lag = 0; lag < lags_.size(); ++lag) {
      ExactSum& sum = sums_[slot(interval, lag, group, tail)];
      for (std::size_t k = begin; k < begin + count; ++k) sum.add(squares_[lag * followed_.size() + disks[k]]);
    }
  }
}

std::size_t Mobility::slot(std::size_t interval, std::size_t lag, Group group, Tail tail) const {
  return ((interval * lags_.size() + lag) * groups.size() + static_cast<std::size_t>(group)) * 2 + tail;
}

double Mobility::sum(std::size_t interval, std::size_t lag, Group group, Tail tail) const {
  const double scale = displacement_scale(lags_[lag]);
  return sums_[slot(interval, lag, group, tail)].value() / (scale * scale);
}

void Mobility::append(const Mobility& other, std::size_t first, std::size_t intervals) {
  const auto size = static_cast<std::ptrdiff_t>(lags_.size() * groups.size() * 2);
  const auto begin = other.sums_.begin() + static_cast<std::ptrdiff_t>(first) * size;
  sums_.insert(sums_.end(), begin, begin + static_cast<std::ptrdiff_t>(intervals) * size);
}

std::vector<Field> Mobility::fields() { return {{"mobility_squares", &squares_}, {"mobility_sums", &sums_}}; }

}  // namespace sandglass
