#pragma once
/// From a recorded distance to a beam.
#include <cmath>
#include <limits>

#include "core/observations.hpp"

namespace noctule::datasets {

/// Distance of a ping that heard nothing.
inline constexpr double kNoEcho = std::numeric_limits<double>::infinity();

/// A beam of a recorded distance [m]: no echo beyond the scan's largest range, saturated below its smallest.
[[nodiscard]] inline UltrasonicBeam beam(const Pose2& sensor_in_base, double distance, const UltrasonicScan& scan) {
  if (distance > scan.max_range) return {sensor_in_base, 0.0, Echo::none};
  if (distance < scan.min_range) return {sensor_in_base, 0.0, Echo::saturated};
  return {sensor_in_base, distance, Echo::hit};
}

/// A beam of a ring of sonars that look outwards, at `bearing` [rad] and `radius` [m] from the centre of the base.
[[nodiscard]] inline UltrasonicBeam ring_beam(double bearing, double radius, double distance,
                                              const UltrasonicScan& scan) {
  return beam({radius * std::cos(bearing), radius * std::sin(bearing), bearing}, distance, scan);
}

}  // namespace noctule::datasets
