#include "sandglass/core/version.h"

namespace sandglass {

const char* const version = SANDGLASS_VERSION;

}  // namespace sandglass
