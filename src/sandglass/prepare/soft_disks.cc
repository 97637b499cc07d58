#include "sandglass/prepare/soft_disks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sandglass/prepare/periodic.h"

namespace sandglass {
SoftDisks::SoftDisks(double box_length, std::vector<SoftDisk> disks)
    : box_length_(box_length),
      disks_(std::move(disks)),
      sorted_disks_(disks_.size()),
      ids_(disks_.size()),
      sorted_ids_(disks_.size()),
      listed_at_(disks_.size()),
      partner_end_(disks_.size()) {
  double largest = 0;
  for (std::size_t slot = 0; slot < disks_.size(); ++slot) {
    ids_[slot] = static_cast<std::uint32_t>(slot);
    largest = std::max(largest, disks_[slot].radius);
  }
  // Three cells a side at least, or a pair of cells would meet twice.
  skin_ = std::min(skin * largest, box_length / 3 - 2 * largest);
  cells_ = std::max(cells_, static_cast<std::size_t>(box_length_ / (2 * largest + skin_)));
  remake_lists();
}

void SoftDisks::step(double swelling) {
  move();
  if (lists_due_) remake_lists();
  apply_forces(swelling);
}

void SoftDisks::move() {
  double farthest = 0;
  for (std::size_t slot = 0; slot < disks_.size(); ++slot) {
    SoftDisk& disk = disks_[slot];
    disk.vx += time_step * disk.inverse_mass * disk.fx;
    disk.vy += time_step * disk.inverse_mass * disk.fy;
    disk.x += time_step * disk.vx;
    disk.y += time_step * disk.vy;
    disk.fx = disk.fy = 0;
    const double dx = disk.x - listed_at_[slot].x, dy = disk.y - listed_at_[slot].y;
    farthest = std::max(farthest, dx * dx + dy * dy);
  }
  lists_due_ = 4 * farthest > skin_ * skin_;
}

void SoftDisks::apply_forces(double swelling) {
  const double box = box_length_;
  std::size_t entry = 0;
  for (std::size_t slot = 0; slot < disks_.size(); ++slot) {
    const SoftDisk a = disks_[slot];
    double fx = a.fx, fy = a.fy;
    for (const std::size_t end = partner_end_[slot]; entry < end; ++entry) {
      SoftDisk& b = disks_[partners_[entry]];
      const double dx = nearest_image(a.x - b.x, box), dy = nearest_image(a.y - b.y, box);
      const double squared = dx * dx + dy * dy, contact = swelling * (a.radius + b.radius);
      if (squared >= contact * contact) continue;
      // Coincident centres have no line of centres; the tiny addend leaves that pair without a force.
      const double distance = std::sqrt(squared + 1e-300);
      const double inverse = 1 / distance, nx = dx * inverse, ny = dy * inverse;
      const double separation_speed = (a.vx - b.vx) * nx + (a.vy - b.vy) * ny;
      const double force = stiffness * (contact - distance) - dashpot * separation_speed;
      fx += force * nx, fy += force * ny;
      b.fx -= force * nx, b.fy -= force * ny;
    }
    disks_[slot].fx = fx, disks_[slot].fy = fy;
  }
}

double SoftDisks::deepest_overlap() const {
  double deepest = 0;
  std::size_t entry = 0;
  for (std::size_t slot = 0; slot < disks_.size(); ++slot) {
    const SoftDisk& a = disks_[slot];
    for (const std::size_t end = partner_end_[slot]; entry < end; ++entry) {
      const SoftDisk& b = disks_[partners_[entry]];
      const double dx = nearest_image(a.x - b.x, box_length_), dy = nearest_image(a.y - b.y, box_length_);
      deepest = std::max(deepest, 1 - std::sqrt(dx * dx + dy * dy) / (a.radius + b.radius));
    }
  }
  return deepest;
}

void SoftDisks::remake_lists() {
  sort_by_cell();
  list_partners();
  lists_due_ = false;
}

/// Counting sort of the disks by cell, row after row; disks of one cell keep their order.
void SoftDisks::sort_by_cell() {
  const double per_length = static_cast<double>(cells_) / box_length_;
  const auto line = [&](double x) { return std::min(static_cast<std::size_t>(x * per_length), cells_ - 1); };
  const auto cell_of = [&](const SoftDisk& disk) { return line(disk.y) * cells_ + line(disk.x); };
  cell_start_.assign(cells_ * cells_ + 1, 0);
  for (SoftDisk& disk : disks_) {
    disk.x = wrapped(disk.x, box_length_), disk.y = wrapped(disk.y, box_length_);
    ++cell_start_[cell_of(disk)];
  }
  std::uint32_t total = 0;
  for (std::uint32_t& start : cell_start_) total += start, start = total;
  // Now the ends of the cells; filling them from behind turns ends into starts.
  for (std::size_t slot = disks_.size(); slot-- > 0;) {
    const std::uint32_t target = --cell_start_[cell_of(disks_[slot])];
    sorted_disks_[target] = disks_[slot];
    sorted_ids_[target] = ids_[slot];
    listed_at_[target] = {disks_[slot].x, disks_[slot].y};
  }
  disks_.swap(sorted_disks_);
  ids_.swap(sorted_ids_);
}

/// Lists each pair once: within a cell, to the right, and to the three cells of the next row.
void SoftDisks::list_partners() {
  partners_.clear();
  for (std::size_t row = 0; row < cells_; ++row) {
    const std::size_t next_row = (row + 1) % cells_;
    for (std::size_t column = 0; column < cells_; ++column) {
      const std::size_t left = (column + cells_ - 1) % cells_, right = (column + 1) % cells_;
      const std::array<std::size_t, 4> neighbours{row * cells_ + right, next_row * cells_ + left,
                                                  next_row * cells_ + column, next_row * cells_ + right};
      const std::size_t here = row * cells_ + column;
      for (std::uint32_t slot = cell_start_[here]; slot < cell_start_[here + 1]; ++slot) {
        list_among(disks_[slot], slot + 1, cell_start_[here + 1]);
        for (const std::size_t cell : neighbours) list_among(disks_[slot], cell_start_[cell], cell_start_[cell + 1]);
        partner_end_[slot] = static_cast<std::uint32_t>(partners_.size());
      }
    }
  }
}

void SoftDisks::list_among(const SoftDisk& disk, std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t slot = first; slot < last; ++slot) {
    const SoftDisk& other = disks_[slot];
    const double dx = nearest_image(disk.x - other.x, box_length_), dy = nearest_image(disk.y - other.y, box_length_);
    const double near = disk.radius + other.radius + skin_;
    if (dx * dx + dy * dy < near * near) partners_.push_back(slot);
  }
}

}  // namespace sandglass
