// Reading a file that no checksum protects: in a process of its own.
#pragma once

#include <filesystem>
#include <functional>

#include "sandglass/core/state.h"

namespace sandglass {

/// What `read` returns (of the State what a frame holds: box, mixture, centres, images, velocities), called in a child
/// process whose time and memory are limited by the size of the file `path`. The HDF5 library was not made for damaged
/// or hostile files: on some it crashes, never ends, or takes all memory, and then only the child is lost. Throws
/// InputError with the message of the one that `read` threw, or if the child died.
State read_apart(const std::filesystem::path& path, const std::function<State()>& read);

/// The same for what is too much to be handed over: `read` is called in such a child and forgets what it reads. Where
/// it has come to its end there, reading the same bytes here is safe. Throws InputError in the same way.
void try_apart(const std::filesystem::path& path, const std::function<void()>& read);

}  // namespace sandglass
