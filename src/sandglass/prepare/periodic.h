// Coordinates in a periodic box of side L.
#pragma once

#include <cmath>

namespace sandglass {

/// The image of `coordinate` in [0, L).
inline double wrapped(double coordinate, double box_length) {
  const double inside = coordinate - box_length * std::floor(coordinate / box_length);
  return inside < 0 || inside >= box_length ? 0.0 : inside;  // rounding at either border
}

/// The difference of two coordinates, less than L apart from [0, L), to its nearest image.
inline double nearest_image(double difference, double box_length) {
  if (difference > 0.5 * box_length) return difference - box_length;
  if (difference < -0.5 * box_length) return difference + box_length;
  return difference;
}

}  // namespace sandglass
