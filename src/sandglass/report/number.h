// Numbers for people.
#pragma once

#include <string>

namespace sandglass {

/// A value and its standard error in the usual short form, two digits of the error when they begin with 1, else one:
/// with_error(0.6163, 0.0011) is "0.6163(11)", with_error(87.24, 0.3) is "87.2(3)". Without a positive, finite error
/// four digits of the value; a value that is no number is "unknown".
std::string with_error(double value, double error);

/// Four significant digits, whole (and grouped) numbers from 1000 on; from 10^6 on, or below 10^-3, as "1.234·10⁻⁵".
std::string short_number(double value);

/// A count with thin spaces between groups of three: "10 000".
std::string grouped(unsigned long long count);

}  // namespace sandglass
