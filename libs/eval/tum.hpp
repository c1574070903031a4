#pragma once
#include <span>
#include <string>

#include "eval/trajectory.hpp"

namespace noctule::eval {

/// A trajectory in the format of the TUM RGB-D benchmark: one line `timestamp tx ty tz qx qy qz qw` a pose, seconds
/// with six decimals, metres, unit quaternion. Every number reads back as it was.
[[nodiscard]] std::string to_tum(std::span<const TimedPose> trajectory);

}  // namespace noctule::eval
