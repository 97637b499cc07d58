// Mutations of HDF5 files through the library itself: the file stays one, what is in it becomes anything.
#pragma once

#include <filesystem>

#include "memory_file.h"

/// Each target of HDF5 files defines it: a small good file, of which all inputs are mutations.
void write_seed(const std::filesystem::path& path);
