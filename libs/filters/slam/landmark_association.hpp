#pragma once
/// Which landmark of one particle each sighting of a message belongs to.
#include <array>
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

/// What decides where sightings belong, as numbers that hold for all particles.
struct MatchRule {
  SightingParameters parameters;
  std::array<double, 3> log_new;  ///< log density of sightings of unmapped landmarks, of each DetectionKind
  double one_number;              ///< one number strays as far as two do where its square is this much smaller

  explicit MatchRule(const SightingParameters& p);
  [[nodiscard]] double log_density_of_new(DetectionKind kind) const { return log_new[static_cast<std::size_t>(kind)]; }
};

/// base * mount, without the trigonometry where the sensor sits on the base's origin.
[[nodiscard]] inline Pose2 sensor_pose(const Pose2& base, const Pose2& mount) {
  if (mount.x == 0.0 && mount.y == 0.0) return {base.x, base.y, wrap(base.yaw + mount.yaw)};
  return base * mount;
}

/// What becomes of a sighting, where it is not the slot of its landmark: dropped, or the first slot beyond the map
/// (one landmark more for each of them), where it starts one.
inline constexpr std::int32_t kDropped = -1;
/// Of a bearing or range alone: nothing on the map, but something that may become a landmark (landmark_tracks.hpp).
inline constexpr std::int32_t kTracked = -2;

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

/// The same for a sighting: without what it does not measure.
[[nodiscard]] inline Eigen::Matrix<double, 2, 3> by_motion(const Sighting& z, const Innovation& v,
                                                           const Vector2& heading, const Vector2& lever) {
  auto h = by_motion(v, heading, lever);
  if (!z.is_whole()) h.row(z.kind == DetectionKind::bearing_only ? 0 : 1).setZero();
  return h;
}

/// A map as landmarks of a particle. \throws InputError for landmarks that are no points
[[nodiscard]] std::vector<PointLandmark> point_landmarks(const LandmarkMap& map);

/// Sightings with an identity go to the landmark of that name. The others are matched to the rest of the map within a
/// gate; one that is far from all landmarks starts a new one, or is tracked; one in between is dropped.
/// \param[out] slots one per sighting
void associate(const LandmarkScan& scan, const PredictedPose& pose, const LandmarkMaps& maps, std::size_t particle,
               const MatchRule& rule, std::span<std::int32_t> slots);

}  // namespace noctule::filters
