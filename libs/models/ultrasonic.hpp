#pragma once
/// Ultrasonic range models shared by filters, sensors, mapping and sim. A ping from a sensor at p returns the distance
/// to the nearest reflector inside its cone, along the reflector's own normal (specular), not along the cone's axis.
#include <cmath>
#include <string>

#include "core/features.hpp"
#include "core/parameters.hpp"

namespace noctule::models {

/// Standard deviation of one range, s(r) = base + relative * r [m]. HC-SR04: 0.3 cm + 0.5 % r.
struct RangeNoise {
  double base = 0.003;
  double relative = 0.005;

  [[nodiscard]] double sd(double range) const { return base + relative * range; }

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("base_cm", &RangeNoise::base, unit::centimetre, "standard deviation of a range at distance 0", positive());
    v.field("relative", &RangeNoise::relative, unit::one, "growth of the standard deviation with the range",
            at_least(0.0));
  }
};

/// Predicted range and direction of the echo of a reflector, with Jacobians.
/// \tparam D number of the reflector's parameters
template <int D>
struct EchoPrediction {
  double range = 0.0;                                ///< [m]
  double direction = 0.0;                            ///< of the echo, map frame [rad]
  Eigen::RowVector2d range_by_position;              ///< d range / d sensor position
  Eigen::Matrix<double, 1, D> range_by_feature;      ///< d range / d parameters
  Eigen::RowVector2d direction_by_position;          ///< d direction / d sensor position
  Eigen::Matrix<double, 1, D> direction_by_feature;  ///< d direction / d parameters
};

/// Wall (rho, theta): r = rho - n.p, direction theta.
[[nodiscard]] inline EchoPrediction<2> predict_echo(const Vector2& sensor, const Wall& wall) {
  const Vector2 n = wall.normal(), t = wall.tangent();
  EchoPrediction<2> e;
  e.range = wall.rho - n.dot(sensor);
  e.direction = wall.theta;
  e.range_by_position = -n.transpose();
  e.range_by_feature << 1.0, -t.dot(sensor);
  e.direction_by_position.setZero();
  e.direction_by_feature << 0.0, 1.0;
  return e;
}

/// Cylinder (x, y, R), a point when R = 0: r = |c - p| - R, direction atan2(c - p). The sensor must not stand on the
/// centre: closer than 1e-6 m the Jacobians are 0.
[[nodiscard]] inline EchoPrediction<3> predict_echo(const Vector2& sensor, const Cylinder& cylinder) {
  const Vector2 d = cylinder.centre - sensor;
  const double length = d.norm();
  EchoPrediction<3> e;
  e.range = length - cylinder.radius;
  e.direction = std::atan2(d.y(), d.x());
  e.range_by_position.setZero();
  e.range_by_feature.setZero();
  e.direction_by_position.setZero();
  e.direction_by_feature.setZero();
  if (length < 1e-6) return e;
  const Vector2 u = d / length;
  e.range_by_position = -u.transpose();
  e.range_by_feature << u.x(), u.y(), -1.0;
  e.direction_by_position << u.y() / length, -u.x() / length;
  e.direction_by_feature << -u.y() / length, u.x() / length, 0.0;
  return e;
}

}  // namespace noctule::models
