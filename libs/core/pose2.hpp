#pragma once
/// Rigid motions of the plane (REP-103: x forward, y left, yaw counter-clockwise from x).
#include <Eigen/Core>
#include <cmath>

#include "core/angles.hpp"

namespace noctule {

using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix2 = Eigen::Matrix2d;
using Matrix3 = Eigen::Matrix3d;

/// Pose of a frame B in a frame A: position [m] and heading [rad]. 24 bytes, trivially copyable.
/// `a_T_b * b_T_c == a_T_c`.
struct Pose2 {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  [[nodiscard]] Vector2 position() const { return {x, y}; }
  [[nodiscard]] Vector3 vector() const { return {x, y, yaw}; }
  [[nodiscard]] bool finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(yaw); }
  friend bool operator==(const Pose2&, const Pose2&) = default;
};

/// Composition a_T_c = a_T_b * b_T_c; the heading of the result is wrapped.
[[nodiscard]] inline Pose2 operator*(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y, wrap(a.yaw + b.yaw)};
}

/// Point of frame B expressed in frame A.
[[nodiscard]] inline Vector2 operator*(const Pose2& a, const Vector2& point) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  return {a.x + c * point.x() - s * point.y(), a.y + s * point.x() + c * point.y()};
}

[[nodiscard]] inline Pose2 inverse(const Pose2& a) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  return {-c * a.x - s * a.y, s * a.x - c * a.y, wrap(-a.yaw)};
}

/// Pose of b seen from a: inverse(a) * b.
[[nodiscard]] inline Pose2 between(const Pose2& a, const Pose2& b) {
  return inverse(a) * b;
}

/// d(a * b)/d(a), both in their own (x, y, yaw) coordinates.
[[nodiscard]] inline Matrix3 compose_jacobian_left(const Pose2& a, const Pose2& b) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  Matrix3 j = Matrix3::Identity();
  j(0, 2) = -s * b.x - c * b.y;
  j(1, 2) = c * b.x - s * b.y;
  return j;
}

/// d(a * b)/d(b), both in their own (x, y, yaw) coordinates.
[[nodiscard]] inline Matrix3 compose_jacobian_right(const Pose2& a) {
  const double c = std::cos(a.yaw), s = std::sin(a.yaw);
  Matrix3 j = Matrix3::Identity();
  j(0, 0) = c;
  j(0, 1) = -s;
  j(1, 0) = s;
  j(1, 1) = c;
  return j;
}

/// Component-wise difference a - b with the heading wrapped.
[[nodiscard]] inline Vector3 difference(const Pose2& a, const Pose2& b) {
  return {a.x - b.x, a.y - b.y, wrap(a.yaw - b.yaw)};
}

/// A pose with its covariance, order (x, y, yaw), units m^2, m rad, rad^2. Error is additive in (x, y, yaw).
struct PoseGaussian {
  Pose2 mean;
  Matrix3 covariance = Matrix3::Zero();
};

/// First-order composition of two independent uncertain motions.
[[nodiscard]] inline PoseGaussian operator*(const PoseGaussian& a, const PoseGaussian& b) {
  const Matrix3 ja = compose_jacobian_left(a.mean, b.mean);
  const Matrix3 jb = compose_jacobian_right(a.mean);
  return {a.mean * b.mean, ja * a.covariance * ja.transpose() + jb * b.covariance * jb.transpose()};
}

}  // namespace noctule
