#pragma once
/// Sighting of a point landmark by range and bearing.
#include <cmath>

#include "core/pose2.hpp"

namespace noctule::models {

/// Predicted (range [m], bearing [rad]) of a landmark, with its Jacobian by the landmark's position.
struct RangeBearingPrediction {
  Vector2 z;
  Matrix2 by_landmark;
};

/// \param sensor pose of the sensor in the map; closer than 1e-6 m to the landmark the Jacobian is 0
[[nodiscard]] inline RangeBearingPrediction predict_range_bearing(const Pose2& sensor, const Vector2& landmark) {
  const Vector2 d = landmark - sensor.position();
  const double r = d.norm();
  RangeBearingPrediction p;
  p.z << r, wrap(std::atan2(d.y(), d.x()) - sensor.yaw);
  p.by_landmark.setZero();
  if (r < 1e-6) return p;
  p.by_landmark << d.x() / r, d.y() / r, -d.y() / (r * r), d.x() / (r * r);
  return p;
}

/// Where a sighting places its landmark, with the Jacobian of that place by (range, bearing).
struct RangeBearingInverse {
  Vector2 landmark;
  Matrix2 by_sighting;
};
[[nodiscard]] inline RangeBearingInverse place_landmark(const Pose2& sensor, const Vector2& z) {
  const double c = std::cos(sensor.yaw + z[1]), s = std::sin(sensor.yaw + z[1]);
  RangeBearingInverse p;
  p.landmark << sensor.x + z[0] * c, sensor.y + z[0] * s;
  p.by_sighting << c, -z[0] * s, s, z[0] * c;
  return p;
}

}  // namespace noctule::models
