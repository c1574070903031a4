#include "filters/slam/particle_slam.hpp"

#include "core/check.hpp"
#include "core/error.hpp"
#include "filters/checks.hpp"
#include "filters/slam/particle_kernel.hpp"
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
      contours_(particles_.size()),
      points_(particles_.size(), parameters.sightings, {}, MapStorage::automatic, parameters.threads),
      fits_(particles_.size()) {}

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
  observe(scan.stamp, [&](std::size_t begin, std::size_t end) {
    std::vector<char> scratch;
    for (std::size_t i = begin; i < end; ++i) {
      fits_[i] = observation.apply(particles_.poses()[i], contours_[i], scratch);
    }
  });
}

void ParticleSlam::update(const LandmarkDetections& detections) {
  check(detections);
  check_order("landmark detections", detections.stamp, last_detections_);

  move_particles();
  points_.begin(detections, next_id_);
  points_.associate(particles_.poses(), {});
  points_.make_writable();
  observe(detections.stamp, [this](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      fits_[i] = update_map(points_.view(i), particles_.poses()[i], KalmanUpdate{});
    }
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

void ParticleSlam::observe(const Stamp& stamp, const std::function<void(std::size_t, std::size_t)>& body) {
  particle::for_blocks(particles_.size(), parameters_.threads, body);
  particles_.weigh(fits_);
  particles_.record(stamp, fits_);
  const auto ancestors = particles_.resample();
  if (ancestors.empty()) return;
  points_.resample(ancestors);
  // Survivors keep their slots, so that none is overwritten before it is copied.
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    if (ancestors[i] != i) contours_[i] = contours_[ancestors[i]];
  }
}

LandmarkMap ParticleSlam::map() const {
  LandmarkMap result{particles_.estimate().stamp, {}};
  const std::size_t best = particles_.best();
  for (const ContourLandmark& landmark : contours_[best]) result.landmarks.push_back(landmark.estimate());
  for (std::size_t k = 0; k < points_.maps().size(best); ++k) {
    result.landmarks.push_back(points_.maps().at(best, k).estimate());
  }
  return result;
}

}  // namespace noctule::filters
