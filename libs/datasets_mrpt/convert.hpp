#pragma once
/// Between MRPT's values and ours. Header of the plug-in alone: it brings MRPT in.
#include <mrpt/core/Clock.h>
#include <mrpt/math/CMatrixFixed.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/poses/CPose3D.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "core/error.hpp"
#include "core/pose2.hpp"

namespace noctule::datasets {

/// MRPT counts 100 ns from 1601-01-01 UTC and writes 0 for "no time".
inline constexpr std::int64_t kTicksToUnixEpoch = 116'444'736'000'000'000;
inline constexpr std::int64_t kTicksPerMicrosecond = 10;

[[nodiscard]] inline std::optional<std::int64_t> to_utime(mrpt::Clock::time_point time) {
  const std::int64_t ticks = time.time_since_epoch().count();
  if (ticks == 0) return std::nullopt;
  return (ticks - kTicksToUnixEpoch) / kTicksPerMicrosecond;
}
[[nodiscard]] inline mrpt::Clock::time_point to_time(std::int64_t utime) {
  return mrpt::Clock::time_point(mrpt::Clock::duration(kTicksToUnixEpoch + kTicksPerMicrosecond * utime));
}

[[nodiscard]] inline Pose2 to_pose(const mrpt::poses::CPose2D& p) {
  return {p.x(), p.y(), wrap(p.phi())};
}
[[nodiscard]] inline mrpt::poses::CPose2D to_mrpt(const Pose2& p) {
  return {p.x, p.y, p.yaw};
}
[[nodiscard]] inline mrpt::poses::CPose3D to_mrpt_3d(const Pose2& p) {
  return {p.x, p.y, 0.0, p.yaw, 0.0, 0.0};
}

/// The pose in the plane of a sensor that is level.
/// \param place of the sensor, for the message
/// \throws InputError when it is not level
[[nodiscard]] inline Pose2 to_level_pose(const mrpt::poses::CPose3D& p, const std::string& place) {
  constexpr double kLevel = 1e-3;  // [rad]
  if (!(std::abs(p.pitch()) < kLevel && std::abs(p.roll()) < kLevel)) {
    throw InputError(place + ": expected a level sensor, got pitch " + std::to_string(p.pitch()) + " rad, roll " +
                     std::to_string(p.roll()) + " rad");
  }
  return {p.x(), p.y(), wrap(p.yaw())};
}

}  // namespace noctule::datasets
