// What every fuzz target shares: bad input may throw InputError and nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "sandglass/core/errors.h"

namespace sandglass {

/// Any other exception ends the process, which is a finding.
template <class Call>
void read_or_refuse(Call&& call) {
  try {
    call();
  } catch (const InputError&) {
  }
}

inline void require(bool condition) {
  if (!condition) std::abort();
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace sandglass
