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

}  // namespace noctule::models
