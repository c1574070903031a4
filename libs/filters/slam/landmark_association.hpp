#pragma once
/// Which landmark of one particle each sighting of a message belongs to.
#include <cstdint>
#include <span>
#include <vector>

#include "core/pose2.hpp"
#include "filters/slam/landmark_maps.hpp"
#include "filters/slam/parameters.hpp"

namespace noctule::filters {

/// The sightings of one message.
struct LandmarkScan {
  Pose2 sensor_in_base;
  std::vector<Sighting> sightings;  ///< those with an identity first, in its order
};

/// base * mount, without the trigonometry where the sensor sits on the base's origin.
[[nodiscard]] inline Pose2 sensor_pose(const Pose2& base, const Pose2& mount) {
  if (mount.x == 0.0 && mount.y == 0.0) return {base.x, base.y, wrap(base.yaw + mount.yaw)};
  return base * mount;
}

/// What becomes of a sighting, where it is not the slot of its landmark: dropped, or the first slot beyond the map
/// (one landmark more for each of them), where it starts one.
inline constexpr std::int32_t kDropped = -1;

/// Where a particle will be, before the scan is taken in: `base` moves by the motion, which is still uncertain.
struct PredictedPose {
  Pose2 base;           ///< before the motion
  PoseGaussian motion;  ///< in its frame
};

/// d (range, bearing) of the sensor's predictions by the motion (x, y, yaw) in the frame of the pose before it.
/// \param heading cosine and sine of that pose's yaw
/// \param lever from the base, where the motion ends, to the sensor, map
[[nodiscard]] inline Eigen::Matrix<double, 2, 3> by_motion(const Innovation& v, const Vector2& heading,
                                                           const Vector2& lever) {
  const double ux = heading.x() * v.ux + heading.y() * v.uy, uy = heading.x() * v.uy - heading.y() * v.ux;
  const double along = v.uy * lever.x() - v.ux * lever.y();  // how the range grows when the base turns
  const double across = v.ux * lever.x() + v.uy * lever.y();
  Eigen::Matrix<double, 2, 3> h;
  h << -ux, -uy, -along, v.inverse_range * uy, -v.inverse_range * ux, -v.inverse_range * across - 1.0;
  return h;
}

/// Sightings with an identity go to the landmark of that name. The others are matched to the rest of the map within a
/// gate; one that is far from all landmarks starts a new one, one in between is dropped.
/// \param[out] slots one per sighting
void associate(const LandmarkScan& scan, const PredictedPose& pose, const LandmarkMaps& maps, std::size_t particle,
               const SightingParameters& parameters, std::span<std::int32_t> slots);

}  // namespace noctule::filters
