#include "modules/posed_scans.hpp"

#include <algorithm>

namespace noctule::modules {
namespace {

constexpr double kLongestGap = 0.5;  // [s]

}  // namespace

void Trajectory::add(std::int64_t utime, const Pose2& pose) {
  if (!poses_.empty() && poses_.back().utime > utime) return;
  if (!poses_.empty() && poses_.back().utime == utime) poses_.pop_back();
  poses_.push_back({utime, pose});
}

void Trajectory::move(const Odometry& odometry, const Pose2& start) {
  const Pose2& latest = poses_.empty() ? start : poses_.back().pose;
  add(odometry.stamp.utime, latest * odometry.increment);
}

std::optional<Pose2> Trajectory::at(std::int64_t utime) const {
  if (between_ == Between::linear) return eval::interpolate(poses_, utime, kLongestGap);
  const auto later = std::ranges::upper_bound(poses_, utime, {}, &eval::TimedPose::utime);
  if (later == poses_.begin()) return std::nullopt;
  const eval::TimedPose& latest = *std::prev(later);
  if (between_ == Between::nothing && latest.utime != utime) return std::nullopt;
  return latest.pose;
}

std::vector<mapping::PosedScan> posed_scans(const std::vector<UltrasonicScan>& scans, const Trajectory& trajectory) {
  std::vector<mapping::PosedScan> posed;
  posed.reserve(scans.size());
  for (const UltrasonicScan& scan : scans) {
    if (const auto pose = trajectory.at(scan.stamp.utime)) posed.push_back({scan, *pose});
  }
  return posed;
}

}  // namespace noctule::modules
