// From a State into the engine's tables, and back.
#include <cmath>

#include "sandglass/dynamics/isa_engine.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

OverlappingPair IsaEngine::load(const std::uint32_t* order) {
  size_ = state_.disks.size();
  until_stall_check_ = 1;
  progress_time_ = -never;
  const Disk* const disks = state_.disks.data();
  if (cold_.size() != size_) {
    records_ = Array<Record>(size_ + 1);
    cold_ = Array<ColdRecord>(size_);
    // Fills the empty places of neighbour lists: every contact would come after what it has next.
    records_[size_] = {0, 0, 0, 0, 0, -never, 0, no_disk, Next::review, small, 0};
  }
  neighbours_ = Neighbours(size_, box_, state_.mixture, default_skin(), default_cell_size());
  leash_ = neighbours_.leash();
  for (std::uint32_t i = 0; i < size_; ++i) {
    const Disk& disk = disks[order[i]];
    records_[i] = {disk.x,  disk.y,       disk.vx,      disk.vy, disk.time, never, state_.mixture.radius[disk.species],
                   no_disk, Next::review, disk.species, 0};
    Record now = records_[i];
    std::int32_t image_x = 0, image_y = 0;
    advance(now, image_x, image_y, state_.now, box_);
    cold_[i] = {.centre = neighbours_.grid().point(now.x, now.y),
                .last_contact = disk.last_contact,
                .next_kick = disk.next_kick,
                .kick_count = disk.kick_count,
                .image_x = disk.image_x,
                .image_y = disk.image_y,
                .id = order[i]};
  }
  state_.disks = std::vector<Disk>();  // gives the memory back

  OverlappingPair deepest;
  for (std::uint32_t i = 0; i < size_; ++i) {
    neighbours_.enter(i, cold_[i].centre, &records_[0]);
    for (std::uint32_t n = 0; n < records_[i].neighbour_count; ++n) {
      const std::uint32_t k = neighbours_.list(i)[n];
      const double contact = records_[i].radius + records_[k].radius;
      const double gap = surface_gap(records_[i], records_[k], contact, state_.now, box_);
      if (gap < -1e-9 * contact && -gap > deepest.depth) deepest = {cold_[k].id, cold_[i].id, -gap};
    }
  }

  // First predictions into a calendar where nearly all is far ahead, only to learn how far that is.
  calendar_ = Calendar(state_.now, 0, 1e-12 * state_.epoch_length, 0);
  for (std::uint32_t i = 0; i < size_; ++i) predict(i);
  const double lead = mean_lead();
  calendar_ = Calendar(state_.now, lead, window_events() * lead / static_cast<double>(size_), size_);
  for (std::uint32_t i = 0; i < size_; ++i)
    if (records_[i].next_time < never) calendar_.push(records_[i].next_time, i);
  return deepest;
}

/// Width of the lists beyond contact: a circle of that range holds about eight centres at the given density.
double IsaEngine::default_skin() const {
  const double room = box_.length / 2 - 2 * largest_radius();  // wider, and nearest images would no longer be unique
  if (tuning_.skin > 0) return std::fmin(tuning_.skin, room);
  const double area_per_disk = box_.length * box_.length / static_cast<double>(size_);
  const double contact = state_.mixture.radius[small] + state_.mixture.radius[big];
  const double skin = std::sqrt(8 * area_per_disk / 3.14159) - contact;
  return std::fmin(std::fmax(skin, 0.2 * contact), room);
}

/// Two disks to a cell, of the five that there is room for in a line of the grid.
double IsaEngine::default_cell_size() const {
  if (tuning_.cell_size > 0) return tuning_.cell_size;
  return box_.length * std::sqrt(2 / static_cast<double>(size_));
}

/// Events in a window of the calendar. The larger, the more are entered into the open window, which is slower; the
/// smaller, the more windows are being filled, and no longer fit into the cache.
double IsaEngine::window_events() const {
  if (tuning_.window_events > 0) return tuning_.window_events;
  return std::fmin(std::fmax(2 * std::sqrt(static_cast<double>(size_)), 8), 4096);
}

/// About the mean time from now to a disk's next event, from the median over a sample of disks: the median of an
/// exponential distribution is ln 2 of its mean.
double IsaEngine::mean_lead() const {
  const std::size_t step = size_ / 1024 + 1;
  double low = 0, high = state_.epoch_length;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    std::size_t below = 0, all = 0;
    for (std::size_t slot = 0; slot < size_; slot += step, ++all)
      below += records_[slot].next_time - state_.now < middle;
    (2 * below < all ? low : high) = middle;
  }
  return std::fmax(high, 1e-9 * state_.epoch_length) / 0.69;
}

void IsaEngine::forget_what_comes() {
  neighbours_ = Neighbours();
  calendar_ = Calendar();
}

void IsaEngine::store(Disk* disks) const {
  for (std::size_t i = 0; i < size_; ++i) {
    const Record& record = records_[i];
    const ColdRecord& cold = cold_[i];
    Disk& disk = disks[cold.id];
    disk.x = record.x;
    disk.y = record.y;
    disk.vx = record.vx;
    disk.vy = record.vy;
    disk.time = record.time;
    disk.last_contact = cold.last_contact;
    disk.next_kick = cold.next_kick;
    disk.kick_count = cold.kick_count;
    disk.image_x = cold.image_x;
    disk.image_y = cold.image_y;
    disk.species = record.species;
  }
}

void IsaEngine::make_frame(double* x, double* y, double* vx, double* vy) const {
  for (std::size_t i = 0; i < size_; ++i) {
    const Record& record = records_[i];
    const ColdRecord& cold = cold_[i];
    const double flight = state_.now - record.time;
    x[cold.id] = record.x + record.vx * flight + cold.image_x * box_.length;
    y[cold.id] = record.y + record.vy * flight + cold.image_y * box_.length;
    vx[cold.id] = record.vx;
    vy[cold.id] = record.vy;
  }
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
