// Cells of comma-separated files.
#pragma once

#include <string>
#include <string_view>

namespace sandglass {

/// Text, in quotes where it holds a comma, a quote or the end of a line [RFC 4180].
std::string csv_cell(std::string_view text);

/// A number that reads back to the same bits; empty for one that is not known.
std::string csv_cell(double value);

}  // namespace sandglass
