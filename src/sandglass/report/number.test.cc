#include "sandglass/report/number.h"

#include <doctest/doctest.h>

#include <limits>

namespace sandglass {

TEST_CASE("a value with its error shows the digits that the error allows") {
  CHECK(with_error(0.6163, 0.0011) == "0.6163(11)");
  CHECK(with_error(87.24, 0.3) == "87.2(3)");
  CHECK(with_error(-0.5, 0.06) == "-0.50(6)");
  CHECK(with_error(1.0, 0.0196) == "1.000(20)");  // 1.96e-2 begins with 1: two digits, rounded up
  CHECK(with_error(1.0, 0.0099) == "1.000(10)");  // one digit would round to 10: two are as good
  CHECK(with_error(12345, 12) == "12345(12)");
  CHECK(with_error(12344, 30) == "12\u2009340 ± 30");
  CHECK(with_error(2951, 235.2) == "3\u2009000 ± 200");
  CHECK(with_error(2951, 185.2) == "2\u2009950 ± 190");
}

TEST_CASE("without an error or a value it says so") {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  CHECK(with_error(0.12345, none) == "0.1235");
  CHECK(with_error(0.12345, 0) == "0.1235");
  CHECK(with_error(none, 0.1) == "unknown");
  CHECK(short_number(std::numeric_limits<double>::infinity()) == "unknown");
  CHECK(short_number(3.1e-5) == "3.100·10⁻⁵");
  CHECK(short_number(0) == "0");
  CHECK(short_number(-10000) == "-10\u2009000");
  CHECK(short_number(-2.5e6) == "-2.500·10⁶");
}

TEST_CASE("counts are grouped") {
  CHECK(grouped(7) == "7");
  CHECK(grouped(10000) == "10\u2009000");
  CHECK(grouped(18446744073709551615ull) == "18\u2009446\u2009744\u2009073\u2009709\u2009551\u2009615");
}

}  // namespace sandglass
