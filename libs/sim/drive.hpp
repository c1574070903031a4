#pragma once
/// The true motion of the robot along its path.
#include <vector>

#include "sim/robot.hpp"
#include "sim/world.hpp"

namespace noctule::sim {

/// Motion between two readings of the odometry.
struct Motion {
  double duration = 0.0;                 ///< [s]
  Pose2 pose;                            ///< true pose at its end
  Pose2 increment;                       ///< true pose at its end, in the base at its begin
  Matrix3 covariance = Matrix3::Zero();  ///< of the odometry's error, order (x, y, yaw) of the increment
  bool stop = false;                     ///< the robot stands still at its end and listens
};

/// The whole way, free of noise and independent of any seed. Odometry noise is spread over the motions so that it adds
/// up as OdometryNoise says: the error of a step, from one stop to the next, is shared in proportion to the length of
/// its parts; that of a turn, which is all the turning between two way-points, in proportion to the angle.
/// \throws InputError when a way-point cannot be reached by the steering, or the way comes within kPathClearance of an
///         obstacle
[[nodiscard]] std::vector<Motion> plan_motions(const WorldParameters&, const RobotParameters&);

}  // namespace noctule::sim
