#include "filters/slam/particle_slam.hpp"

#include "core/check.hpp"
#include "core/error.hpp"
#include "filters/checks.hpp"
#include "particle/parallel.hpp"

namespace noctule::filters {
namespace {

std::size_t checked_size(const ParticleSlamParameters& parameters, const Pose2& start) {
  require_sound(parameters, "particle SLAM");
  if (!start.finite()) throw InputError("particle SLAM: start: expected a finite pose");
  return static_cast<std::size_t>(parameters.particles);
}

}  // namespace

ParticleSlam::ParticleSlam(const ParticleSlamParameters& parameters, std::uint64_t seed, const Pose2& start)
    : parameters_(parameters),
      seed_(seed),
      particles_(checked_size(parameters, start), start, {parameters.resampling, parameters.resample_below, {}}, seed,
                 stream_id("particle_slam.resampling")),
      maps_(particles_.size()) {}

void ParticleSlam::predict(const Odometry& odometry) {
  check(odometry);
  proposal_.add(odometry);
}

void ParticleSlam::update(const UltrasonicScan& scan, const ContourFeatures& features) {
  check(scan);
  check(features, scan);
  check_order("ultrasonic scan", scan.stamp, last_scan_);

  move_particles();
  const ContourObservation observation(scan, features, stop_, next_id_, parameters_);
  next_id_ -= static_cast<std::int64_t>(features.features.size());
  observe(scan.stamp, [&](const Pose2& base, Map& map, std::vector<char>& scratch) {
    return observation.apply(base, map.contours, scratch);
  });
}

void ParticleSlam::update(const LandmarkDetections& detections) {
  check(detections);
  check_order("landmark detections", detections.stamp, last_detections_);

  move_particles();
  const std::int64_t first_id = next_id_;
  next_id_ -= static_cast<std::int64_t>(detections.detections.size());
  observe(detections.stamp, [&](const Pose2& base, Map& map, std::vector<char>&) {
    return apply_sightings(detections, base, first_id, parameters_.sightings, map.points);
  });
}

void ParticleSlam::move_particles() {
  const PoseGaussian& motion = proposal_.motion();
  way_from_stop_ += motion.mean.position().norm();
  if (way_from_stop_ >= parameters_.contour_landmarks.stop_distance) {
    ++stop_;
    way_from_stop_ = 0.0;
  }
  const OdometryProposal::Sampler sample(motion);
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Pose2& pose = particles_.poses()[i];
    pose =
        pose * sample(Rng(seed_, stream_id("particle_slam.motion"), particles_.step(), static_cast<std::uint32_t>(i)));
  }
  proposal_.reset();
}

template <class Apply>
void ParticleSlam::observe(const Stamp& stamp, Apply apply) {
  std::vector<ObservationFit> fits(particles_.size());
  particle::for_blocks(particles_.size(), parameters_.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<char> scratch;
    for (std::size_t i = begin; i < end; ++i) fits[i] = apply(particles_.poses()[i], maps_[i], scratch);
  });
  particles_.weigh(fits);
  particles_.record(stamp, fits);
  // Survivors keep their slots, so that none is overwritten before it is copied.
  const auto ancestors = particles_.resample();
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    if (ancestors[i] != i) maps_[i] = maps_[ancestors[i]];
  }
}

LandmarkMap ParticleSlam::map() const {
  LandmarkMap result{particles_.estimate().stamp, {}};
  const Map& best = maps_[particles_.best()];
  for (const ContourLandmark& landmark : best.contours) result.landmarks.push_back(landmark.estimate());
  for (const PointLandmark& point : best.points) result.landmarks.push_back(point.estimate());
  return result;
}

}  // namespace noctule::filters
