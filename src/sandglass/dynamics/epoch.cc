#include "sandglass/dynamics/epoch.h"

#include "sandglass/dynamics/contact.h"

namespace sandglass {

void pass_epoch(State& state) {
  const Box box(state.box_length, state.mixture);
  for (Disk& disk : state.disks) {
    advance(disk, disk.image_x, disk.image_y, state.epoch_length, box);
    disk.time = 0;
    disk.last_contact -= state.epoch_length;
    disk.next_kick -= state.epoch_length;
  }
  state.now = 0;
  ++state.epoch;
}

}  // namespace sandglass
