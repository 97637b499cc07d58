// From a State into the engine's tables, and back.
#include <cmath>

#include "sandglass/dynamics/isa_engine.h"

namespace sandglass {
inline namespace SANDGLASS_ISA {

OverlappingPair IsaEngine::load(const std::uint32_t* order) {
  const std::size_t size = state_.disks.size();
  tables_.size = size;
  if (tables_.cold.size() != size) {
    tables_.records = Array<Record>(size + 1);
    tables_.cold = Array<ColdRecord>(size);
    tables_.ids = Array<std::uint32_t>(size);
    tables_.images = Array<Image>(size);
    // Fills the empty places of neighbour lists: every contact would come after what it has next.
    tables_.records[size] = Record{0, 0, 0, 0, 0, nobodys, 0, no_disk, Next::review, small, false, true, Home::none, 0};
  }
  for (std::uint32_t i = 0; i < size; ++i) {
    const Disk& disk = state_.disks[order[i]];
    tables_.records[i] =
        Record{disk.x,  disk.y,       disk.vx,      disk.vy, disk.time, never,      state_.mixture.radius[disk.species],
               no_disk, Next::review, disk.species, false,   true,      Home::none, 0};
    tables_.cold[i] = {.listed = {},
                       .centre = {},
                       .last_contact = disk.last_contact,
                       .next_kick = disk.next_kick,
                       .kick_count = disk.kick_count};
    tables_.ids[i] = order[i];
    tables_.images[i] = {disk.image_x, disk.image_y};
  }
  state_.disks = std::vector<Disk>();  // gives the memory back
  windows_done_ = undone_ = 0;
  tables_.out_of_cache = tables_.size > tuning_.most_in_cache;
  tables_.in_batches = works_in_batches();
  const OverlappingPair deepest = make_lists();
  if (strips_ == 1)
    make_calendar();
  else
    divide();
  return deepest;
}

/// With few disks most events are beside one another; with many, memory is waited for, and a batch asks for too much of
/// it at a time; kicks would end most batches (bench/RESULTS.md).
bool IsaEngine::works_in_batches() const {
  if (tables_.out_of_cache) return false;
  if (tuning_.batches != Tuning::Batches::where_faster) return tuning_.batches == Tuning::Batches::always;
  return state_.drive.kind == DriveKind::none && tables_.size >= 2000;
}

/// Lists and predictions for the records as they are. Returns the deepest overlap beyond rounding, if any.
OverlappingPair IsaEngine::make_lists() {
  Array<Record>& records = tables_.records;
  tables_.neighbours = NeighbourTable(tables_.cold, tables_.box, state_.mixture, default_skin(), default_cell_size());
  const Neighbours neighbours(tables_.neighbours);
  strips_ = strips_for_threads(neighbours);
  tables_.leash[true] = neighbours.leash();
  tables_.leash[false] = tables_.leash[true] - (strips_ > 1 ? way() / 2 : 0);
  make_zones(neighbours);
  whole_.hand_in(state_.tally, bookkeeping);
  whole_ = Strip(tables_);
  whole_.log = log;
  for (std::uint32_t i = 0; i < tables_.size; ++i) {
    set_next(records[i], never, Next::review, no_disk);
    records[i].neighbour_count = 0;
    Flight now(records[i]);
    std::int32_t image_x = 0, image_y = 0;
    advance(now, image_x, image_y, state_.now, tables_.box);
    records[i].concerned = false;
    whole_.set_centre(i, whole_.neighbours().grid().point(now.x, now.y));
  }
  OverlappingPair deepest;
  for (std::uint32_t i = 0; i < tables_.size; ++i) {
    whole_.enter_list(i);
    for (std::uint32_t n = 0; n < records[i].neighbour_count; ++n) {
      const std::uint32_t k = whole_.neighbours().listed(i, n);
      const double contact = records[i].radius + records[k].radius;
      const double gap = surface_gap(records[i], records[k], contact, state_.now, tables_.box);
      if (gap < -1e-9 * contact && -gap > deepest.depth) deepest = {tables_.ids[k], tables_.ids[i], -gap};
    }
  }
  // First predictions into a calendar where nearly all is far ahead, only to learn how far that is.
  whole_.set_calendar(Calendar(state_.now - state_.epoch_length, state_.epoch_length, state_.epoch_length, 0, false));
  for (std::uint32_t i = 0; i < tables_.size; ++i) whole_.predict(i);
  return deepest;
}

/// The calendar of all disks, where there is but one strip.
void IsaEngine::make_calendar() {
  whole_.set_calendar(calendar_for(mean_lead(), tables_.size));
  for (std::uint32_t i = 0; i < tables_.size; ++i)
    if (tables_.records[i].next_time < never) whole_.enter_calendar(i);
}

/// Width of the lists beyond contact: a circle of that range holds about eight centres at the given density.
double IsaEngine::default_skin() const {
  const double room = 2 * tables_.box.transit;  // wider, and nearest images would no longer be unique
  if (tuning_.skin > 0) return std::fmin(tuning_.skin, room);
  const double area_per_disk = tables_.box.length * tables_.box.length / static_cast<double>(tables_.size);
  const double contact = state_.mixture.radius[small] + state_.mixture.radius[big];
  const double skin = std::sqrt(8 * area_per_disk / 3.14159) - contact;
  return std::fmin(std::fmax(skin, 0.2 * contact), room);
}

/// A line of the grid has room for five disks: three to a cell, or two where they are not packed closely (packing
/// fractions below 0.4) and more cells would be too full. With threads their size is such that some rows are just one
/// range high: lanes are made of whole rows.
double IsaEngine::default_cell_size() const {
  if (tuning_.cell_size > 0) return tuning_.cell_size;
  const auto& radius = state_.mixture.radius;
  const double area_per_disk = tables_.box.length * tables_.box.length / static_cast<double>(tables_.size);
  const double contact = radius[small] + radius[big];
  const double cell = std::sqrt((contact * contact > 0.5 * area_per_disk ? 3 : 2) * area_per_disk);
  const double range = 2 * std::fmax(radius[small], radius[big]) + default_skin();
  return crew ? (1 + 1e-4) * range / std::fmax(1, std::round(range / cell)) : cell;
}

/// A calendar for `size` disks whose next events are `lead` ahead. The more events in a window, the more are entered
/// into the open one, which is slower; the fewer, the more windows are being filled, and no longer fit into the cache.
Calendar IsaEngine::calendar_for(double lead, std::size_t size) const {
  const auto disks = static_cast<double>(size);
  double events = std::fmin(std::fmax(2 * std::sqrt(disks), 8), 4096);
  if (tuning_.window_events > 0) events = tuning_.window_events;
  return Calendar(state_.now, lead, events * lead / disks, size, tables_.out_of_cache);
}

/// About the mean time from now to a disk's next event, from the median over a sample of disks: the median of an
/// exponential distribution is ln 2 of its mean.
double IsaEngine::mean_lead() const {
  const std::size_t step = tables_.size / 1024 + 1;
  double low = 0, high = state_.epoch_length;
  for (int i = 0; i < 50; ++i) {
    const double middle = (low + high) / 2;
    std::size_t below = 0, all = 0;
    for (std::size_t slot = 0; slot < tables_.size; slot += step, ++all)
      below += tables_.records[slot].next_time - state_.now < middle;
    (2 * below < all ? low : high) = middle;
  }
  return std::fmax(high, 1e-9 * state_.epoch_length) / 0.69;
}

void IsaEngine::forget_what_comes() {
  tables_.neighbours = NeighbourTable();
  whole_ = Strip();
  first_.reset();
  shifted_.reset();
  kept_ = {};
}

void IsaEngine::store(Disk* disks) const {
  for (std::size_t i = 0; i < tables_.size; ++i) {
    const Record& record = tables_.records[i];
    const ColdRecord& cold = tables_.cold[i];
    Disk& disk = disks[tables_.ids[i]];
    disk.x = record.x;
    disk.y = record.y;
    disk.vx = record.vx;
    disk.vy = record.vy;
    disk.time = record.time;
    disk.last_contact = cold.last_contact;
    disk.next_kick = cold.next_kick;
    disk.kick_count = cold.kick_count;
    disk.image_x = tables_.images[i].x;
    disk.image_y = tables_.images[i].y;
    disk.species = record.species;
  }
}

void IsaEngine::make_frame(double* x, double* y, double* vx, double* vy) const {
  for (std::size_t i = 0; i < tables_.size; ++i) {
    const Record& record = tables_.records[i];
    const Image image = tables_.images[i];
    const std::uint32_t id = tables_.ids[i];
    const double flight = state_.now - record.time;
    x[id] = record.x + record.vx * flight + image.x * tables_.box.length;
    y[id] = record.y + record.vy * flight + image.y * tables_.box.length;
    vx[id] = record.vx;
    vy[id] = record.vy;
  }
}

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
