#include "sandglass/study/memory.h"

#include <doctest/doctest.h>

#include "sandglass/core/errors.h"

using namespace sandglass;

TEST_CASE("a run must fit into memory") {
  CHECK(available_memory() > 0);
  CHECK_NOTHROW(require_memory(1000));
  CHECK_THROWS_AS(require_memory(std::uint64_t{1} << 50), InputError);
}
