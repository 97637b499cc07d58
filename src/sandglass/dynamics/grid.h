// Where the list centres are: a periodic grid of small cells.
#pragma once

#include <cmath>
#include <cstdint>

#include "sandglass/core/state.h"
#include "sandglass/dynamics/array.h"
#include "sandglass/dynamics/simd.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// A point in fixed point: the box is 2^32 units long, so that differences wrap to the nearest image by themselves.
struct FixedPoint {
  std::uint32_t x, y;
};

/// One cache line of a cell. Lanes without a point have the name `empty`.
struct alignas(64) Cell {
  static constexpr std::uint32_t capacity = 5, empty = 0xffffffffu, slot_bits = 0x7fffffffu;
  std::uint32_t x[capacity] = {}, y[capacity] = {};
  std::uint32_t name[capacity] = {empty, empty, empty, empty, empty};  // slot, and the species in the highest bit
  std::uint32_t more = 0;                                              // index of the cell's next line, or 0

  [[nodiscard]] unsigned lanes_of(std::uint32_t wanted) const {
    unsigned lanes = 0;
    for (std::uint32_t lane = 0; lane < capacity; ++lane) lanes |= unsigned{name[lane] == wanted} << lane;
    return lanes;
  }
};
static_assert(sizeof(Cell) == 64);

/// The memory of a grid: side * side first lines, row by row, then second and further lines, which are rare.
struct GridTable {
  GridTable() = default;
  GridTable(double length, double cell_size) : box_length(length) {
    const double cells = std::floor(length / cell_size);
    side = cells < 1 ? 1 : cells > 32768 ? 32768 : static_cast<std::uint32_t>(cells);
    used = side * side;
    lines = Array<Cell>(used + used / 8 + 64);
    for (std::uint32_t i = 0; i < used; ++i) lines[i] = Cell();
  }

  double box_length = 0;
  std::uint32_t side = 1;  // cells along one side of the box
  std::uint32_t used = 0;  // lines that belong to a cell, or to a Grid that may use them
  Array<Cell> lines;
};

/// Points with a name (slot and species), found by their place. Every thread has a Grid of its own on the one table;
/// what two of them change at a time must lie in different cells.
class Grid {
 public:
  Grid() = default;
  explicit Grid(GridTable& table)
      : unit_(table.box_length * 0x1p-32),
        per_unit_(0x1p32 / table.box_length),
        side_(table.side),
        table_(&table),
        cells_(table.lines.begin()) {}

  /// Cells along one side of the box.
  [[nodiscard]] std::uint32_t side() const { return side_; }
  [[nodiscard]] std::uint32_t row_of(FixedPoint at) const { return line_of(at.y); }

  /// How many rows from the edge of a row on a search from beyond that edge may look.
  [[nodiscard]] std::uint32_t rows_within(double radius) const {
    return static_cast<std::uint32_t>((radius * per_unit_ + 2) * side_ * 0x1p-32) + 1;
  }

  /// Takes `count` unused lines for the cells that will need a second one. Other Grids must be told (refresh).
  void take_lines(std::uint32_t count) {
    const std::uint32_t first = table_->used;
    if (first + count > table_->lines.size()) table_->lines.enlarge(first + count + table_->lines.size() / 16);
    for (std::uint32_t i = first; i < first + count; ++i) table_->lines[i] = Cell();  // not before: unused is no memory
    spare_ = first;
    spare_end_ = table_->used = first + count;
    refresh();
  }
  [[nodiscard]] std::uint32_t spare_lines() const { return spare_end_ - spare_; }

  /// The table may have moved.
  void refresh() { cells_ = table_->lines.begin(); }

  /// Length of a unit of the fixed point.
  [[nodiscard]] double unit() const { return unit_; }

  /// The point at a position, which may lie a few boxes outside.
  [[gnu::always_inline]] FixedPoint point(double x, double y) const { return {to_fixed(x), to_fixed(y)}; }

  /// From a point to a position (one coordinate), nearest image.
  [[gnu::always_inline]] double offset(std::uint32_t from, double to) const {
    return static_cast<double>(static_cast<std::int32_t>(to_fixed(to) - from)) * unit_;
  }

  void place(std::uint32_t slot, FixedPoint at, Species species) {
    for (std::uint32_t index = cell_of(at);; index = cells_[index].more) {
      Cell& cell = cells_[index];
      if (const unsigned lanes = cell.lanes_of(Cell::empty); lanes != 0) [[likely]] {
        const auto lane = static_cast<unsigned>(__builtin_ctz(lanes));
        cell.x[lane] = at.x, cell.y[lane] = at.y, cell.name[lane] = slot | std::uint32_t{species} << 31;
        return;
      }
      if (cell.more == 0) {
        if (spare_ == spare_end_) take_lines(64);
        cells_[index].more = spare_++;
      }
    }
  }

  void displace(std::uint32_t slot, FixedPoint at, Species species) {
    for (std::uint32_t index = cell_of(at);; index = cells_[index].more) {
      Cell& cell = cells_[index];
      if (const unsigned lanes = cell.lanes_of(slot | std::uint32_t{species} << 31); lanes != 0) [[likely]] {
        cell.name[static_cast<unsigned>(__builtin_ctz(lanes))] = Cell::empty;
        return;
      }
    }
  }

  struct Slots {
    const std::uint32_t* first;
    std::uint32_t count;
  };

  /// The slots of all points closer to `at` than `range` of their species. Distances are taken in single precision:
  /// which of two points nearer than 1e-6 to the range are in is arbitrary, but the same from both sides. The answer
  /// lives until the next call.
  [[gnu::always_inline]] Slots within(FixedPoint at, const double (&range)[species_count]) {
    const double range_small = range[small] * per_unit_, range_big = range[big] * per_unit_;
    const Reach reach{at, static_cast<float>(range_small * range_small), static_cast<float>(range_big * range_big)};
    std::uint32_t count = 0;
    visit_cells(at, range[small] > range[big] ? range[small] : range[big], [&](const Cell& cell) {
      if (count + 16 > found_.size()) [[unlikely]]
        found_.enlarge(2 * found_.size() + 64);
      count += reach.collect(cell, &found_[count]);
    });
    return {&found_[0], count};
  }

  /// Brings what within() will read nearer to the processor.
  [[gnu::always_inline]] void fetch(FixedPoint at, double radius) const {
    visit_lines(at, radius, [](const Cell& cell) { prefetch(&cell); });
  }

  /// Calls visit(slot) for every point within `radius` of (x, y), and for some farther ones. Returns whether that was
  /// every point there is.
  template <class Visit>
  [[gnu::always_inline]] bool visit_near(double x, double y, double radius, Visit&& visit) const {
    return visit_cells(point(x, y), radius, [&](const Cell& cell) {
      for (const std::uint32_t name : cell.name)
        if (name != Cell::empty) visit(name & Cell::slot_bits);
    });
  }

  /// The least distance of points that have `rows` rows between theirs.
  [[nodiscard]] double height(std::uint32_t rows) const { return (0x1p32 / side_ * rows - 2) * unit_; }

  /// Calls visit(slot) for every point in the rows from `row` on.
  template <class Visit>
  void visit_rows(std::uint32_t row, std::uint32_t count, Visit&& visit) const {
    for (; count > 0; --count, row = row + 1 == side_ ? 0 : row + 1)
      for (std::size_t column = 0; column < side_; ++column)
        for (const Cell* cell = &cells_[row * side_ + column];; cell = &cells_[cell->more]) {
          for (const std::uint32_t name : cell->name)
            if (name != Cell::empty) visit(name & Cell::slot_bits);
          if (cell->more == 0) break;
        }
  }

 private:
  /// A circle by species around a point.
  struct Reach {
    FixedPoint at;
    float small_squared, big_squared;

    /// Writes the slots of the cell's points inside to `out`, which has room for 16; returns how many they are.
    [[gnu::always_inline]] std::uint32_t collect(const Cell& cell, std::uint32_t* out) const {
#if defined(SANDGLASS_SIMD) && defined(__AVX512DQ__)
      const __m512i line = _mm512_load_si512(&cell);
      const __m512i origin =
          _mm512_mask_set1_epi32(_mm512_set1_epi32(static_cast<int>(at.x)), 0x3e0, static_cast<int>(at.y));
      const __m512 difference = _mm512_cvtepi32_ps(_mm512_sub_epi32(line, origin));
      const __m512 square = _mm512_mul_ps(difference, difference);
      const __m512i y_square = _mm512_alignr_epi32(_mm512_castps_si512(square), _mm512_castps_si512(square), 5);
      const __m512i name = _mm512_alignr_epi32(line, line, 10);
      const __m512 limit =
          _mm512_mask_blend_ps(_mm512_movepi32_mask(name), _mm512_set1_ps(small_squared), _mm512_set1_ps(big_squared));
      const __m512 distance = _mm512_add_ps(square, _mm512_castsi512_ps(y_square));
      const __mmask16 taken = _mm512_mask_cmpneq_epi32_mask(0x1f, name, _mm512_set1_epi32(-1));
      const __mmask16 inside = _mm512_mask_cmp_ps_mask(taken, distance, limit, _CMP_LT_OQ);
      const __m512i slots = _mm512_and_si512(name, _mm512_set1_epi32(Cell::slot_bits));
      _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(inside, slots));
      return static_cast<std::uint32_t>(__builtin_popcount(inside));
#else
      std::uint32_t count = 0;
      for (std::uint32_t lane = 0; lane < Cell::capacity; ++lane) {
        const std::uint32_t name = cell.name[lane];
        const auto dx = static_cast<float>(static_cast<std::int32_t>(cell.x[lane] - at.x));
        const auto dy = static_cast<float>(static_cast<std::int32_t>(cell.y[lane] - at.y));
        const float limit = name >> 31 ? big_squared : small_squared;
        out[count] = name & Cell::slot_bits;  // without a branch, since that cannot be foretold
        count += (dx * dx + dy * dy < limit) & (name != Cell::empty);
      }
      return count;
#endif
    }
  };

  [[gnu::always_inline]] std::uint32_t to_fixed(double position) const {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(position * per_unit_));
  }
  [[gnu::always_inline]] std::uint32_t line_of(std::uint32_t coordinate) const {
    return static_cast<std::uint32_t>(std::uint64_t{coordinate} * side_ >> 32);
  }
  [[gnu::always_inline]] std::uint32_t cell_of(FixedPoint at) const { return line_of(at.y) * side_ + line_of(at.x); }

  /// Calls visit(cell) for the first line of all cells that a circle may touch. Returns whether those were all cells.
  template <class Visit>
  [[gnu::always_inline]] bool visit_lines(FixedPoint at, double radius, Visit&& visit) const {
    const double reach = radius * per_unit_ + 2;
    const bool all = !(reach < 0x1p31 - 0x1p32 / side_);
    auto range = [&](std::uint32_t coordinate, std::uint32_t& first, std::uint32_t& count) {
      if (all) {
        first = 0, count = side_;
        return;
      }
      const auto half = static_cast<std::uint32_t>(reach);
      first = line_of(coordinate - half);
      const std::uint32_t last = line_of(coordinate + half);
      count = (last >= first ? last - first : last + side_ - first) + 1;
    };
    std::uint32_t column = 0, row = 0, columns = 0, rows = 0;
    range(at.x, column, columns);
    range(at.y, row, rows);
    const std::uint32_t first_column = column;
    for (std::uint32_t j = 0; j < rows; ++j) {
      for (std::uint32_t i = 0; i < columns; ++i) {
        visit(cells_[std::size_t{row} * side_ + column]);
        if (++column == side_) column = 0;
      }
      column = first_column;
      if (++row == side_) row = 0;
    }
    return all;
  }

  /// The same with every line.
  template <class Visit>
  [[gnu::always_inline]] bool visit_cells(FixedPoint at, double radius, Visit&& visit) const {
    return visit_lines(at, radius, [&](const Cell& first) {
      visit(first);
      for (const Cell* cell = &first; cell->more != 0;) {
        cell = &cells_[cell->more];
        visit(*cell);
      }
    });
  }

  double unit_ = 0, per_unit_ = 0;
  std::uint32_t side_ = 1;
  std::uint32_t spare_ = 0, spare_end_ = 0;  // lines for this Grid to use
  GridTable* table_ = nullptr;
  Cell* cells_ = nullptr;
  Array<std::uint32_t> found_;
};

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
