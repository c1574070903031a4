#include "filters/localisation/global_localisation.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "core/error.hpp"
#include "filters/checks.hpp"

namespace noctule::filters {
namespace {

constexpr std::uint64_t kSpread = stream_id("global_localisation.spread");
constexpr std::uint64_t kMotion = stream_id("global_localisation.motion");
constexpr std::uint64_t kJitter = stream_id("global_localisation.jitter");
constexpr double kLeastGap = 0.01;  // [m]

std::size_t checked_size(const GlobalLocalisationParameters& parameters) {
  require_sound(parameters, "global localisation");
  return static_cast<std::size_t>(parameters.particles);
}

}  // namespace

GlobalLocalisation::GlobalLocalisation(const LandmarkMap& map, const GlobalLocalisationParameters& parameters,
                                       const SightingParameters& sightings, std::uint64_t seed)
    : parameters_(parameters),
      rule_(sightings),
      seed_(seed),
      particles_(checked_size(parameters), {}, {particle::Resampling::systematic, 0.5, {}}, seed,
                 stream_id("global_localisation.resampling")),
      fits_(particles_.size()) {
  map_ = point_landmarks(map);
  if (map_.empty()) throw InputError("global localisation: expected a map with point landmarks, got none");
}

void GlobalLocalisation::predict(const Odometry& odometry) {
  check(odometry);
  proposal_.add(odometry);
}

void GlobalLocalisation::update(const LandmarkDetections& detections) {
  check(detections);
  std::vector<Sighting> sightings;
  for (const LandmarkDetection& d : detections.detections) sightings.emplace_back(d, 0);
  std::size_t skipped = sightings.size();
  if (!spread_) {
    if (!spread(detections)) return;
    skipped = 0;  // particles were drawn by the first one
  } else {
    const WhitenedMotion whitened(proposal_.motion());
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      Pose2& pose = particles_.poses()[i];
      pose = whitened.drawn(pose, Rng(seed_, kMotion, particles_.step(), static_cast<std::uint32_t>(i)));
    }
  }
  proposal_.reset();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    fits_[i] = fit(sensor_pose(particles_.poses()[i], detections.sensor_in_base), sightings, skipped);
  }
  particles_.weigh(fits_);
  particles_.record(detections.stamp, fits_);
  const Matrix3& p = particles_.estimate().covariance;
  const bool near = p(0, 0) + p(1, 1) < std::pow(parameters_.settled_position, 2) &&
                    p(2, 2) < std::pow(parameters_.settled_heading, 2);
  settled_for_ = near ? settled_for_ + 1 : 0;
  if (!particles_.resample().empty()) jitter();
}

/// Draws all particles from the first sighting that may be of something on the map: a landmark, all directions from it
/// alike, and the rest as the sighting says, or evenly where it says nothing.
bool GlobalLocalisation::spread(const LandmarkDetections& message) {
  if (message.detections.empty()) return false;
  const Sighting z(message.detections[0], 0);
  std::vector<const PointLandmark*> may_be;
  for (const PointLandmark& m : map_) {
    if (z.id < 0 || m.id == z.id) may_be.push_back(&m);
  }
  if (may_be.empty()) return false;
  const Pose2 base_in_sensor = inverse(message.sensor_in_base);
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Rng rng(seed_, kSpread, 0, static_cast<std::uint32_t>(i));
    const PointLandmark& m = *may_be[i % may_be.size()];
    const Vector2 place = m.position() + semidefinite_cholesky<2>(m.covariance()) * Vector2(rng.normal(), rng.normal());
    const double range = z.kind == DetectionKind::bearing_only ? parameters_.view_range * std::sqrt(rng.uniform())
                                                               : z.range + std::sqrt(z.rr) * rng.normal();
    const double bearing =
        z.kind == DetectionKind::range_only ? rng.uniform(-kPi, kPi) : z.bearing + std::sqrt(z.bb) * rng.normal();
    const double direction = rng.uniform(-kPi, kPi);  // to the landmark
    const Pose2 sensor{place.x() - range * std::cos(direction), place.y() - range * std::sin(direction),
                       wrap(direction - bearing)};
    particles_.poses()[i] = sensor * base_in_sensor;
  }
  reach_ = z.kind == DetectionKind::bearing_only ? parameters_.view_range : z.range;
  gap_ = kTwoPi * reach_ * static_cast<double>(may_be.size()) / static_cast<double>(particles_.size());
  spread_ = true;
  return true;
}

ObservationFit GlobalLocalisation::fit(const Pose2& sensor, std::span<const Sighting> sightings,
                                       std::size_t skipped) const {
  ObservationFit fit;
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    if (k == skipped) continue;
    const Sighting& z = sightings[k];
    double density = std::exp(rule_.log_density_of_new(z.kind)), nearest = kInf;
    for (const PointLandmark& m : map_) {
      if (z.id >= 0 && m.id != z.id) continue;
      if (z.kind != DetectionKind::bearing_only) {
        const double dx = m.x - sensor.x, dy = m.y - sensor.y, off = z.range - std::sqrt(dx * dx + dy * dy);
        if (off * off > rule_.parameters.new_above * (m.xx + m.yy + z.rr)) continue;
      }
      const PredictedSighting p(m, z, sensor);
      if (z.kind == DetectionKind::bearing_only && p.v.inverse_range * parameters_.view_range < 1.0) continue;
      const double unmeasured = z.is_whole() ? 0.0 : 0.5 * std::log(kTwoPi);
      density += std::exp(p.s.log_density() + unmeasured);
      nearest = std::min(nearest, p.s.distance2);
    }
    fit.log_likelihood += std::log(density);
    if (nearest < rule_.parameters.gate) {
      fit.nis += nearest;
      fit.degrees_of_freedom += z.numbers();
    }
  }
  return fit;
}

/// Copies fill the gaps that were left between particles when they were drawn.
void GlobalLocalisation::jitter() {
  if (gap_ < kLeastGap) return;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Rng rng(seed_, kJitter, particles_.step(), static_cast<std::uint32_t>(i));
    Pose2& pose = particles_.poses()[i];
    pose.x += 0.5 * gap_ * rng.normal();
    pose.y += 0.5 * gap_ * rng.normal();
    pose.yaw = wrap(pose.yaw + 0.5 * gap_ / reach_ * rng.normal());
  }
  gap_ *= 0.5;
}

}  // namespace noctule::filters
