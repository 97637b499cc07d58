#include "sandglass/study/merge.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "sandglass/study/results.h"

namespace sandglass {
namespace {

/// One quantity of one run on its own arguments.
struct Part {
  std::vector<std::vector<double>> axes;
  std::vector<double> companion, value, error, count;
  double length = 0;
};

std::size_t product(const std::vector<std::vector<double>>& axes) {
  std::size_t elements = 1;
  for (const auto& axis : axes) elements *= axis.size();
  return elements;
}

/// What `run` holds of `q`; nothing in `value` when it is not there or its pieces do not fit together.
Part read_part(const RunResults& run, const Quantity& q) {
  auto read = [&](const std::string& name) {
    return name.empty() ? std::vector<double>{} : numbers_of(run.datasets, q.path(name));
  };
  Part part{{}, read(q.companion), read(q.value), read(q.error), read(q.count), run.length};
  for (const std::string& axis : q.axes) part.axes.push_back(read(axis));
  const std::size_t elements = product(part.axes);
  if (part.value.size() != elements) part.value.clear();
  if (part.error.size() != elements) part.error.clear();
  if (part.count.size() != elements) part.count.clear();
  if (part.axes.empty() || part.companion.size() != part.axes.back().size()) part.companion.clear();
  return part;
}

bool same_argument(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)); }

/// All arguments that occur on axis `a`, ascending.
std::vector<double> union_of(std::span<const Part> parts, std::size_t a) {
  std::vector<double> all;
  for (const Part& part : parts) all.insert(all.end(), part.axes[a].begin(), part.axes[a].end());
  std::erase_if(all, [](double x) { return !std::isfinite(x); });
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end(), same_argument), all.end());
  return all;
}

/// Where each argument of `own` stands in `common`; the size of `common` for one that is no number.
std::vector<std::size_t> places(const std::vector<double>& own, const std::vector<double>& common) {
  std::vector<std::size_t> at;
  for (const double x : own) {
    const auto found = std::lower_bound(common.begin(), common.end(), x - 1e-9 * std::abs(x));
    const bool known = found != common.end() && same_argument(*found, x);
    at.push_back(known ? static_cast<std::size_t>(found - common.begin()) : common.size());
  }
  return at;
}

/// Weights of up to four points around x in a polynomial in ln x: (index of the first point, weights).
std::pair<std::size_t, std::vector<double>> lagrange(const std::vector<double>& xs, double x) {
  const std::size_t points = std::min<std::size_t>(4, xs.size());
  auto first = static_cast<std::size_t>(std::lower_bound(xs.begin(), xs.end(), x) - xs.begin());
  first = std::min(first < 2 ? 0 : first - 2, xs.size() - points);
  std::vector<double> weights(points, 1);
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t j = 0; j < points; ++j)
      if (j != i) weights[i] *= std::log(x / xs[first + j]) / std::log(xs[first + i] / xs[first + j]);
  return {first, weights};
}

double weighted(const std::vector<double>& weights, const std::vector<double>& values, std::size_t first,
                std::size_t stride) {
  double plain = 0, logarithmic = 0;
  bool positive = true;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double value = values[first + i * stride];
    plain += weights[i] * value;
    positive = positive && value > 0;
    if (positive) logarithmic += weights[i] * std::log(value);
  }
  return positive ? std::exp(logarithmic) : plain;
}

/// The lags of a run are set by its own collision rate: those of a replica are off by a fraction of a per cent. Brings
/// `part` to the lags `grid` on axis `a`, as far as its own reach (by less than half a step beyond, too). Values by a
/// cubic in ln t through the four nearest, of ln y where all are positive; errors and counts of the nearest.
void resample(Part& part, std::size_t a, const std::vector<double>& grid) {
  const std::vector<double> own = part.axes[a];
  const auto at = places(own, grid);
  const bool fits = std::all_of(at.begin(), at.end(), [&](std::size_t place) { return place < grid.size(); });
  const bool usable = !own.empty() && own.front() > 0 && std::is_sorted(own.begin(), own.end());
  if (fits || !usable) return;
  constexpr double beyond = 1.05;
  std::vector<double> reached;
  for (const double x : grid)
    if (x > own.front() / beyond && x < own.back() * beyond) reached.push_back(x);
  std::size_t inner = 1;
  for (std::size_t b = a + 1; b < part.axes.size(); ++b) inner *= part.axes[b].size();
  const std::size_t outer = part.value.size() / (own.size() * inner), before = own.size();
  Part moved{part.axes, {}, {}, {}, {}, part.length};
  moved.axes[a] = reached;
  const auto nearest = [&](double x) {
    const auto above = static_cast<std::size_t>(std::lower_bound(own.begin(), own.end(), x) - own.begin());
    return above == before || (above > 0 && x / own[above - 1] < own[above] / x) ? above - 1 : above;
  };
  for (std::size_t o = 0; o < outer; ++o) {
    for (const double x : reached) {
      const auto [first, weights] = lagrange(own, x);
      const std::size_t near = nearest(x);
      for (std::size_t i = 0; i < inner; ++i) {
        moved.value.push_back(weighted(weights, part.value, (o * before + first) * inner + i, inner));
        if (!part.error.empty()) moved.error.push_back(part.error[(o * before + near) * inner + i]);
        if (!part.count.empty()) moved.count.push_back(part.count[(o * before + near) * inner + i]);
      }
      if (o == 0 && inner == 1 && !part.companion.empty())
        moved.companion.push_back(weighted(weights, part.companion, first, 1));
    }
  }
  part = std::move(moved);
}

/// Brings the lags of all parts to those of the one that reaches farthest.
void align_lags(std::vector<Part>& parts, const Quantity& q) {
  for (std::size_t a = 0; a < q.axes.size(); ++a) {
    if (q.axes[a] != "time") continue;
    const auto longest = std::max_element(
        parts.begin(), parts.end(), [&](const Part& x, const Part& y) { return x.axes[a].back() < y.axes[a].back(); });
    const std::vector<double> grid = longest->axes[a];
    for (Part& part : parts) resample(part, a, grid);
  }
}

/// Shows `visit` the samples of every element: (element of the union, element of the part).
template <class Visit>
void walk(const Part& part, const std::vector<std::vector<double>>& common, Visit&& visit) {
  std::vector<std::vector<std::size_t>> at;
  for (std::size_t a = 0; a < common.size(); ++a) at.push_back(places(part.axes[a], common[a]));
  for (std::size_t own = 0; own < part.value.size(); ++own) {
    std::size_t rest = own, target = 0, stride = 1;
    bool known = true;
    for (std::size_t a = common.size(); a-- > 0; stride *= common[a].size()) {
      const std::size_t place = at[a][rest % part.axes[a].size()];
      rest /= part.axes[a].size();
      known = known && place < common[a].size();
      target += place * stride;
    }
    if (known) visit(target, own);
  }
}

class Merger {
 public:
  explicit Merger(std::span<const RunResults> runs) : runs_(runs) {}

  void add(const Quantity& q) {
    std::vector<Part> parts;
    for (const RunResults& run : runs_) {
      Part part = read_part(run, q);
      if (!part.value.empty()) parts.push_back(std::move(part));
    }
    if (parts.empty()) return;
    align_lags(parts, q);
    std::vector<std::vector<double>> common;
    Shape shape;
    for (std::size_t a = 0; a < q.axes.size(); ++a) {
      common.push_back(union_of(parts, a));
      shape.push_back(common.back().size());
      put(q.path(q.axes[a]), {common.back().size()}, common.back());
    }
    std::vector<std::vector<Sample>> samples(product(common));
    std::vector<std::uint64_t> count(samples.size());
    for (const Part& part : parts)
      walk(part, common, [&](std::size_t target, std::size_t own) {
        const double weight = part.count.empty() ? part.length : part.count[own];
        const double error = part.error.empty() ? Measured{}.error : part.error[own];
        samples[target].push_back({part.value[own], error, weight});
        if (!part.count.empty()) count[target] += static_cast<std::uint64_t>(part.count[own]);
      });
    std::vector<double> value, error;
    for (const auto& list : samples) {
      const Measured merged = merge(list);
      value.push_back(merged.value);
      error.push_back(merged.error);
    }
    put(q.path(q.value), shape, value);
    const bool spread = parts.size() > 1 && !q.error.empty();
    if (spread || std::any_of(parts.begin(), parts.end(), [](const Part& p) { return !p.error.empty(); }))
      put(q.path(q.error), shape, error);
    if (std::any_of(parts.begin(), parts.end(), [](const Part& p) { return !p.count.empty(); }))
      put(q.path(q.count), shape, count);
    if (!q.companion.empty()) add_companion(q, parts, common.back());
  }

  std::vector<Dataset> results;

 private:
  using Shape = std::vector<std::size_t>;

  template <class T>
  void put(const std::string& path, Shape shape, std::vector<T> values) {
    if (find_dataset(results, path) != nullptr) return;  // arguments are shared by the quantities of a group
    std::string unit;
    for (const RunResults& run : runs_)
      if (const Dataset* dataset = find_dataset(run.datasets, path)) unit = dataset->unit;
    results.push_back({path, std::move(shape), std::move(values), std::move(unit)});
  }

  void add_companion(const Quantity& q, const std::vector<Part>& parts, const std::vector<double>& common) {
    std::vector<std::vector<Sample>> samples(common.size());
    for (const Part& part : parts) {
      if (part.companion.empty()) return;
      const auto at = places(part.axes.back(), common);
      for (std::size_t i = 0; i < at.size(); ++i)
        if (at[i] < common.size()) samples[at[i]].push_back({part.companion[i], 0, part.length});
    }
    std::vector<double> companion;
    for (const auto& list : samples) companion.push_back(merge(list).value);
    put(q.path(q.companion), {common.size()}, companion);
  }

  std::span<const RunResults> runs_;
};

}  // namespace

Measured merge(std::span<const Sample> samples) {
  double weight = 0, sum = 0, within = 0;
  Sample only;
  std::size_t n = 0;
  const auto counts = [](const Sample& s) { return std::isfinite(s.value) && s.weight > 0; };
  for (const Sample& s : samples) {
    if (!counts(s)) continue;
    weight += s.weight;
    sum += s.weight * s.value;
    within += s.weight * s.weight * s.error * s.error;
    only = s;
    ++n;
  }
  if (n == 0) return {};
  if (n == 1) return {only.value, only.error};  // its very bits
  Measured merged{sum / weight, std::sqrt(within) / weight};
  double between = 0;
  for (const Sample& s : samples)
    if (counts(s)) between += s.weight * s.weight * (s.value - merged.value) * (s.value - merged.value);
  const double runs = static_cast<double>(n);
  merged.error = std::fmax(merged.error, std::sqrt(between * runs / (runs - 1)) / weight);  // fmax passes over NaN
  return merged;
}

std::vector<Dataset> merge_results(std::span<const RunResults> runs) {
  Merger merger(runs);
  for (const Quantity& q : quantities()) merger.add(q);
  for (const char* species : {"all", "small"}) {
    // A map is an average over frames on the wave vectors of the box, the same in all runs of a point.
    const std::string path = "/structure/structure_factor/" + std::string(species) + "/map";
    std::vector<std::vector<Sample>> samples;
    const Dataset* first = nullptr;
    for (const RunResults& run : runs) {
      const Dataset* map = find_dataset(run.datasets, path);
      if (map == nullptr || map->shape.size() != 2 || (first != nullptr && map->shape != first->shape)) continue;
      if (first == nullptr) first = map, samples.resize(map->shape[0] * map->shape[1]);
      const auto values = numbers_of(run.datasets, path);
      for (std::size_t i = 0; i < values.size(); ++i) samples[i].push_back({values[i], 0, run.length});
    }
    if (first == nullptr) continue;
    std::vector<double> values;
    for (const auto& list : samples) values.push_back(merge(list).value);
    merger.results.push_back({path, first->shape, values, first->unit});
  }
  return std::move(merger.results);
}

}  // namespace sandglass
