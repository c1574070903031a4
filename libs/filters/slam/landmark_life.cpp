#include "filters/slam/landmark_life.hpp"

#include <algorithm>
#include <cmath>

#include "core/gaussian.hpp"

namespace noctule::filters {
namespace {

bool is_duplicate(const PointLandmark& a, const PointLandmark& b, double gate) {
  const Vector2 d = a.position() - b.position();
  const double bound = gate * (a.xx + a.yy + b.xx + b.yy);
  return d.squaredNorm() < bound && mahalanobis2<2>(d, a.covariance() + b.covariance()) < gate;
}

/// Both are estimates of one point from different sightings, independent given the path.
void merge(PointLandmark& a, const PointLandmark& b) {
  Vector2 mean = a.position();
  Matrix2 covariance = a.covariance();
  joseph_update<2, 2>(mean, covariance, b.position() - a.position(), Matrix2::Identity(), b.covariance());
  a.set(mean, covariance);
  a.existence = std::max(a.existence, b.existence);
  a.observations += b.observations;
}

}  // namespace

bool should_be_seen(const PointLandmark& m, const Pose2& sensor, const Matrix3& pose_covariance,
                    const LandmarkLifeParameters& life) {
  const double dx = m.x - sensor.x, dy = m.y - sensor.y;
  const double r = std::sqrt(dx * dx + dy * dy);
  const double variance = m.xx + m.yy + pose_covariance(0, 0) + pose_covariance(1, 1);
  if (r > life.view_range - life.view_margin * std::sqrt(variance)) return false;
  if (life.view_half_angle >= kPi) return true;
  const double bearing = wrap(std::atan2(dy, dx) - sensor.yaw);
  const double bearing_sd = std::sqrt(variance / std::max(r * r, 1e-12) + pose_covariance(2, 2));
  return std::abs(bearing) < life.view_half_angle - life.view_margin * bearing_sd;
}

void find_events(const LandmarkScan& scan, const PredictedPose& pose, const LandmarkMaps& maps, std::size_t particle,
                 const LandmarkLifeParameters& life, std::span<const std::int32_t> slots, LifeEvents& events) {
  events.size_before = maps.size(particle);
  events.missed.clear();
  events.survivor = events.duplicate = -1;
  const Pose2 sensor = sensor_pose(pose.base * pose.motion.mean, scan.sensor_in_base);
  const auto size = static_cast<std::int32_t>(events.size_before);
  for (std::int32_t slot = 0; slot < size; ++slot) {
    const PointLandmark& m = maps.at(particle, static_cast<std::size_t>(slot));
    if (m.id >= 0 || std::ranges::find(slots, slot) != slots.end()) continue;
    if (should_be_seen(m, sensor, pose.motion.covariance, life)) events.missed.push_back(slot);
    if (life.merge_gate <= 0.0 || events.duplicate >= 0) continue;
    for (const std::int32_t seen : slots) {
      if (seen < 0 || seen >= size) continue;
      const PointLandmark& other = maps.at(particle, static_cast<std::size_t>(seen));
      if (other.id >= 0 || !is_duplicate(other, m, life.merge_gate)) continue;
      events.survivor = seen;
      events.duplicate = slot;
      break;
    }
  }
}

void apply_events(LandmarkMaps& maps, std::size_t particle, const LandmarkLifeParameters& life,
                  std::span<const std::int32_t> slots, LifeEvents& events) {
  for (const std::int32_t slot : slots) {
    if (slot < 0) continue;
    PointLandmark& m = maps.writable(particle, static_cast<std::size_t>(slot));
    const bool is_new = static_cast<std::size_t>(slot) >= events.size_before;
    m.existence = static_cast<float>(is_new ? life.born : m.existence + life.seen);
  }
  if (events.duplicate >= 0) {
    merge(maps.writable(particle, static_cast<std::size_t>(events.survivor)),
          maps.at(particle, static_cast<std::size_t>(events.duplicate)));
  }
  // From the last one on, so that the landmark which takes a slot is none that is still to be judged.
  bool merged = events.duplicate < 0;
  const auto remove_duplicate = [&] {
    maps.remove(particle, static_cast<std::size_t>(events.duplicate));
    merged = true;
  };
  for (auto slot = events.missed.rbegin(); slot != events.missed.rend(); ++slot) {
    if (!merged && events.duplicate > *slot) remove_duplicate();
    if (*slot == events.duplicate) {
      remove_duplicate();
      continue;
    }
    PointLandmark& m = maps.writable(particle, static_cast<std::size_t>(*slot));
    m.existence -= static_cast<float>(life.missed);
    if (m.existence < life.remove_below) maps.remove(particle, static_cast<std::size_t>(*slot));
  }
  if (!merged) remove_duplicate();
}

}  // namespace noctule::filters
