#pragma once
/// Objects that move on at nearly constant velocity, seen by position.
#include <Eigen/Core>

#include "core/pose2.hpp"

namespace noctule::models {

using Vector4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;
using Matrix24 = Eigen::Matrix<double, 2, 4>;

/// State (x, vx, y, vy) [m, m/s]; accelerations are constant within a step and independent between steps.
struct ConstantVelocity {
  double period = 1.0;           ///< [s] of a step
  double acceleration_sd = 0.5;  ///< [m/s^2] of each component

  [[nodiscard]] Matrix4 transition() const {
    Matrix4 f = Matrix4::Identity();
    f(0, 1) = f(2, 3) = period;
    return f;
  }
  /// How an acceleration (ax, ay) changes the state in a step.
  [[nodiscard]] Eigen::Matrix<double, 4, 2> by_acceleration() const {
    Eigen::Matrix<double, 4, 2> b = Eigen::Matrix<double, 4, 2>::Zero();
    b(0, 0) = b(2, 1) = 0.5 * period * period;
    b(1, 0) = b(3, 1) = period;
    return b;
  }
  [[nodiscard]] Matrix4 noise() const {
    const Eigen::Matrix<double, 4, 2> b = by_acceleration();
    return acceleration_sd * acceleration_sd * b * b.transpose();
  }
  /// Position of the state: H.
  [[nodiscard]] static Matrix24 position() {
    Matrix24 h = Matrix24::Zero();
    h(0, 0) = h(1, 2) = 1.0;
    return h;
  }
};

}  // namespace noctule::models
