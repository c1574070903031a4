#pragma once
/// Steering towards a place.
#include <algorithm>
#include <cmath>

#include "core/pose2.hpp"

namespace noctule::sim {

/// Steering angle [rad] after the wheels, now at `steering`, were turned for dt [s] towards `place`.
/// \param limit largest steering angle [rad] \param rate at which the wheels turn [rad/s]
[[nodiscard]] inline double steer_towards(const Vector2& place, const Pose2& pose, double steering, double limit,
                                          double rate, double dt) {
  const Vector2 way = place - pose.position();
  const double turn = wrap(std::atan2(way.y(), way.x()) - pose.yaw - steering);
  return std::clamp(steering + std::clamp(turn, -rate * dt, rate * dt), -limit, limit);
}

}  // namespace noctule::sim
