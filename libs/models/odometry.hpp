#pragma once
/// Noise of wheel odometry, as variances of small motions: what a driver reports with each increment, and what the
/// simulator draws from.
#include <cmath>

#include "core/observations.hpp"
#include "core/parameters.hpp"

namespace noctule::models {

/// Noise of a robot that turns on the spot and drives straight. Distances err by a fraction of each step, headings by
/// a constant per turn and by a random walk along the way.
struct OdometryNoise {
  double distance = 0.04;       ///< sd of a step's length as a fraction of it
  double turn = radians(1.5);   ///< sd of one turn on the spot, whatever its angle [rad]
  double drift = radians(0.7);  ///< sd of the heading after one metre [rad/sqrt(m)]

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("distance", &OdometryNoise::distance, unit::one, "error of a step's length, as a fraction of it",
            at_least(0.0));
    v.field("turn_deg", &OdometryNoise::turn, unit::degree, "heading error of one turn on the spot", at_least(0.0));
    v.field("drift_deg_per_sqrt_m", &OdometryNoise::drift, unit::degree_per_sqrt_metre,
            "heading random walk along the way", at_least(0.0));
  }

  /// Covariance of a straight step of `length` [m], order (x, y, yaw): heading drifts evenly along it, so that the
  /// lateral error is correlated with the final heading.
  [[nodiscard]] Matrix3 straight(double length) const {
    const double l = std::abs(length);
    const double q = drift * drift * l;  // variance of the final heading
    Matrix3 p = Matrix3::Zero();
    p(0, 0) = distance * distance * l * l;
    p(1, 1) = q * l * l / 3.0;
    p(1, 2) = p(2, 1) = q * length / 2.0;
    p(2, 2) = q;
    return p;
  }

  /// Covariance of one turn on the spot.
  [[nodiscard]] Matrix3 turn_on_the_spot() const {
    Matrix3 p = Matrix3::Zero();
    p(2, 2) = turn * turn;
    return p;
  }
};

/// Noise of odometry that arrives in many small increments: a random walk along the path, so that the sum does not
/// depend on how finely the path was cut.
struct OdometryRandomWalk {
  double along = 0.05;          ///< sd of the distance after one metre [m/sqrt(m)]
  double drift = radians(2.0);  ///< sd of the heading after one metre [rad/sqrt(m)]
  double turn = radians(3.0);   ///< sd of the heading after turning one radian [rad/sqrt(rad)]

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("along_m_per_sqrt_m", &OdometryRandomWalk::along, Unit{"m/sqrt(m)", 1.0}, "error of the distance driven",
            at_least(0.0));
    v.field("drift_deg_per_sqrt_m", &OdometryRandomWalk::drift, unit::degree_per_sqrt_metre,
            "heading random walk along the way", at_least(0.0));
    v.field("turn_deg_per_sqrt_rad", &OdometryRandomWalk::turn, Unit{"deg/sqrt(rad)", radians(1.0)},
            "heading random walk while turning", at_least(0.0));
  }

  /// Covariance of one increment, order (x, y, yaw). The heading drifts evenly along it.
  [[nodiscard]] Matrix3 covariance(const Pose2& increment) const {
    const Vector2 step = increment.position();
    const double length = step.norm();
    const double q = drift * drift * length + turn * turn * std::abs(increment.yaw);
    const Vector2 left(-step.y(), step.x());  // the way the end of the step moves when the heading errs
    Matrix3 p = Matrix3::Zero();
    if (length > 0.0) p.topLeftCorner<2, 2>() = along * along / length * step * step.transpose();
    p.topLeftCorner<2, 2>() += q / 3.0 * left * left.transpose();
    p.topRightCorner<2, 1>() = 0.5 * q * left;
    p.bottomLeftCorner<1, 2>() = 0.5 * q * left.transpose();
    p(2, 2) = q;
    return p;
  }
};

}  // namespace noctule::models
