// The version of the program, as written into every result.
#pragma once

namespace sandglass {

/// "major.minor.patch", from the project() line of the top CMakeLists.txt.
extern const char* const version;

}  // namespace sandglass
