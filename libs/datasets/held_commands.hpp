#pragma once
/// Odometry of vehicles that log their commands or encoders: each holds until the next.
#include <cstdint>
#include <span>
#include <vector>

#include "core/source.hpp"
#include "models/odometry.hpp"

namespace noctule::datasets {

/// Motion of the base from a time on.
struct Command {
  std::int64_t utime = 0;
  double speed = 0.0;      ///< [m/s]
  double turn_rate = 0.0;  ///< [rad/s]
};

/// Motion along the arc of one command.
[[nodiscard]] Pose2 held(const Command& command, double duration);

/// Odometry at every command but the first and at every stop, so that the pose of a stop is the one at its time.
/// \param commands by ascending time, at least one; the last holds beyond its time
/// \param stops times at or after the first command, in any order
[[nodiscard]] std::vector<Odometry> integrate(std::span<const Command> commands, std::span<const std::int64_t> stops,
                                              const models::OdometryRandomWalk& noise);

}  // namespace noctule::datasets
