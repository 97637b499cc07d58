// Whether a run fits into the machine, asked before anything is begun.
#pragma once

#include <cstdint>

namespace sandglass {

/// About the most memory that a run of so many disks holds at one time, in bytes: engine, observers, and the copy of
/// the State that is written to a checkpoint.
double needed_memory(std::uint64_t particles);

/// What this process may still take: free memory and swap of the machine, the limit of its control group, its own limit
/// (ulimit -v); infinity where the system does not say.
double available_memory();

/// Throws InputError, with both sizes, where the disks do not fit.
void require_memory(std::uint64_t particles);

}  // namespace sandglass
