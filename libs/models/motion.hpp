#pragma once
/// Motion models of wheeled robots with their Jacobians, shared by filters, planning and sim.
#include <cmath>

#include "core/pose2.hpp"

namespace noctule::models {

/// Pose after one control step of length dt.
struct MotionPrediction {
  Pose2 pose;
  Matrix3 by_pose = Matrix3::Identity();  ///< d pose / d (x, y, yaw) before the step
  Eigen::Matrix<double, 3, 2> by_control = Eigen::Matrix<double, 3, 2>::Zero();  ///< d pose / d the two controls
};

namespace detail {
/// sin(h) / h and its derivative, smooth through h = 0.
inline double sinc(double h) {
  return std::abs(h) < 1e-4 ? 1.0 - h * h / 6.0 : std::sin(h) / h;
}
inline double sinc_derivative(double h) {
  return std::abs(h) < 1e-3 ? h * (h * h / 30.0 - 1.0 / 3.0) : (h * std::cos(h) - std::sin(h)) / (h * h);
}
}  // namespace detail

enum class Integration {
  euler,  ///< along the heading at the start of the step; off by v w dt^2 / 2 to leading order
  arc     ///< along the exact circular arc
};

/// Unicycle: controls are the speed v [m/s] and the turn rate w [rad/s].
/// The arc is written as its chord, of length v dt sinc(w dt / 2) at half the turn, which needs no case for w = 0.
[[nodiscard]] inline MotionPrediction predict_unicycle(const Pose2& start, double speed, double turn_rate, double dt,
                                                       Integration integration = Integration::arc) {
  const double half_turn = integration == Integration::arc ? 0.5 * turn_rate * dt : 0.0;
  const double chord = dt * detail::sinc(half_turn);
  const double c = std::cos(start.yaw + half_turn), s = std::sin(start.yaw + half_turn);
  MotionPrediction m;
  m.pose = {start.x + speed * chord * c, start.y + speed * chord * s, wrap(start.yaw + turn_rate * dt)};
  m.by_pose(0, 2) = -speed * chord * s;
  m.by_pose(1, 2) = speed * chord * c;
  m.by_control << chord * c, 0.0, chord * s, 0.0, 0.0, dt;
  if (integration == Integration::arc) {
    const double stretch = dt * detail::sinc_derivative(half_turn);  // d chord / d half_turn
    m.by_control(0, 1) = 0.5 * dt * speed * (stretch * c - chord * s);
    m.by_control(1, 1) = 0.5 * dt * speed * (stretch * s + chord * c);
  }
  return m;
}

/// Vehicle steered by its front wheels; the pose is that of the centre of the front axle, with the heading of the body
/// (Yuan et al., eq. 13, where X_k on the right must read X_{k-1}). Controls are the speed of the front axle [m/s] and
/// the steering angle [rad]. \param wheelbase distance of the axles [m]
[[nodiscard]] inline MotionPrediction predict_front_axle(const Pose2& start, double speed, double steering,
                                                         double wheelbase, double dt) {
  const double way = speed * dt;
  const double c = std::cos(start.yaw + steering), s = std::sin(start.yaw + steering);
  MotionPrediction m;
  m.pose = {start.x + way * c, start.y + way * s, wrap(start.yaw + way * std::sin(steering) / wheelbase)};
  m.by_pose(0, 2) = -way * s;
  m.by_pose(1, 2) = way * c;
  m.by_control << dt * c, -way * s, dt * s, way * c, dt * std::sin(steering) / wheelbase,
      way * std::cos(steering) / wheelbase;
  return m;
}

/// Speed and turn rate of the centre of the rear axle of a vehicle steered by its front wheels.
struct RearAxleMotion {
  double speed = 0.0;      ///< [m/s]
  double turn_rate = 0.0;  ///< [rad/s]
};
/// From the speed of the left rear wheel, `encoder_left` [m] beside the centre, and the steering angle [rad] (Guivant
/// and Nebot 2001). \param wheelbase distance of the axles [m]
[[nodiscard]] inline RearAxleMotion rear_axle_motion(double encoder_speed, double steering, double wheelbase,
                                                     double encoder_left) {
  const double curvature = std::tan(steering) / wheelbase;
  const double speed = encoder_speed / (1.0 - curvature * encoder_left);
  return {speed, speed * curvature};
}

}  // namespace noctule::models
