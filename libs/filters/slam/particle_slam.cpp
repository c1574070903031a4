#include "filters/slam/particle_slam.hpp"

#include <algorithm>
#include <cmath>

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
      noise_(parameters.noise),
      particles_(checked_size(parameters, start), start, {parameters.resampling, parameters.resample_below, {}}, seed,
                 stream_id("particle_slam.resampling")),
      contours_(particles_.size()),
      points_(particles_.size(), parameters.sightings, {}, MapStorage::automatic, parameters.threads),
      fits_(particles_.size()) {
  if (parameters.smooth_path == SmoothPath::all) {
    smoother_.emplace(parameters.path_smoother, parameters.echo, parameters.contour_landmarks.point_radius_sd, start);
  }
}

void ParticleSlam::predict(const Odometry& odometry) {
  check(odometry);
  proposal_.add(odometry);
}

void ParticleSlam::update(const UltrasonicScan& scan, const ContourFeatures& features) {
  check(scan);
  check(features, scan);
  check_order("ultrasonic scan", scan.stamp, last_scan_);

  begin_motion();
  const WhitenedMotion motion(proposal_.motion());
  const bool informed = parameters_.proposal == EchoProposal::echoes;
  if (!informed) move_particles(motion);
  const auto echoes = static_cast<std::size_t>(
      std::ranges::count(scan.beams, Echo::hit, [](const UltrasonicBeam& beam) { return beam.echo; }));
  noise_.begin(echoes);
  const ContourObservation observation(scan, features, stop_, next_id_, parameters_,
                                       noise_.adapts() ? &noise_.mixture() : nullptr);
  next_id_ -= static_cast<std::int64_t>(features.features.size());
  const std::size_t kept = noise_.adapts() ? echoes : 0;
  residuals_.resize(kept * particles_.size());
  particle::for_blocks(particles_.size(), parameters_.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<char> scratch;
    std::vector<std::int32_t> assigned;
    for (std::size_t i = begin; i < end; ++i) {
      Pose2& pose = particles_.poses()[i];
      double log_correction = 0.0;
      if (informed) {
        const DrawnPose drawn = observation.draw_pose(pose, motion, contours_[i], assigned, motion_rng(i));
        pose = drawn.pose;
        log_correction = drawn.log_correction;
      }
      fits_[i] = observation.apply(pose, contours_[i], scratch, std::span(residuals_).subspan(i * kept, kept));
      fits_[i].log_likelihood += log_correction;
    }
  });
  proposal_.reset();
  observe(scan.stamp, kept);
  if (smoother_) smoother_->add(scan, noise_.mixture());
}

void ParticleSlam::update(const LandmarkDetections& detections) {
  check(detections);
  if (smoother_) {
    throw InputError("landmark detections: expected smooth_path: none, got all, which smooths paths among echoes only");
  }
  check_order("landmark detections", detections.stamp, last_detections_);

  begin_motion();
  move_particles(WhitenedMotion(proposal_.motion()));
  proposal_.reset();
  points_.begin(detections, next_id_);
  points_.associate(particles_.poses(), {});
  points_.make_writable();
  particle::for_blocks(particles_.size(), parameters_.threads, [this](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      fits_[i] = update_map(points_.view(i), particles_.poses()[i], KalmanUpdate{});
    }
  });
  points_.live(particles_.poses(), particles_.best(), fits_);
  observe(detections.stamp);
}

void ParticleSlam::begin_motion() {
  const PoseGaussian& motion = proposal_.motion();
  way_from_stop_ += motion.mean.position().norm();
  if (way_from_stop_ >= parameters_.contour_landmarks.stop_distance) {
    ++stop_;
    way_from_stop_ = 0.0;
  }
  if (smoother_) smoother_->add_node(motion);
}

void ParticleSlam::move_particles(const WhitenedMotion& motion) {
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    Pose2& pose = particles_.poses()[i];
    pose = motion.drawn(pose, motion_rng(i));
  }
}

void ParticleSlam::observe(const Stamp& stamp, std::size_t echoes) {
  particles_.weigh(fits_);
  if (echoes > 0) learn_noise(echoes);
  particles_.record(stamp, fits_);
  const auto ancestors = particles_.resample();
  if (ancestors.empty()) return;
  points_.resample(ancestors);
  // Survivors keep their slots, so that none is overwritten before it is copied.
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    if (ancestors[i] != i) contours_[i] = contours_[ancestors[i]];
  }
}

void ParticleSlam::begin_on(const LandmarkMap& map, const ParticleCloud& poses) {
  particles_.spread(poses);
  points_.begin_on(point_landmarks(map), next_id_);
}

void ParticleSlam::transfer(StateArchive& archive) {
  archive(proposal_, noise_, noise_scale_, particles_, contours_, points_, next_id_, stop_, way_from_stop_, last_scan_,
          last_detections_);
  if (smoother_) archive(*smoother_);
  if (particles_.poses().size() != fits_.size()) throw InputError("state: expected that of as many particles");
}

void ParticleSlam::learn_noise(std::size_t echoes) {
  learned_.clear();
  const std::vector<double> weights = particles_.weights().linear();
  double noise = 0.0, heard = 0.0;
  for (std::size_t s = 0; s < echoes; ++s) {
    NoiseResidual<1> residual{.weight = 0.0};
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const EchoResidual& r = residuals_[i * echoes + s];
      if (r.noise <= 0.0) continue;
      residual.weight += weights[i];
      residual.mean[0] += weights[i] * r.mean;
      residual.second_moment(0, 0) += weights[i] * r.second_moment;
      noise += weights[i] * r.noise;
    }
    if (residual.weight < 1e-6) continue;
    heard += residual.weight;
    residual.mean /= residual.weight;
    residual.second_moment /= residual.weight;
    learned_.push_back(residual);
  }
  if (learned_.empty()) return;
  noise_.learn(learned_);
  noise_scale_ = std::sqrt(noise / heard);
}

SlamEstimate ParticleSlam::estimate() const {
  SlamEstimate estimate = particles_.estimate();
  estimate.noise_scale = noise_scale_;
  return estimate;
}

PathEstimate ParticleSlam::path() const {
  PathEstimate path = particles_.path();
  if (const auto smooth = smoothed()) {
    for (std::size_t k = 0; k < path.poses.size(); ++k) path.poses[k].pose = smooth->poses[k];
  }
  return path;
}

std::optional<SmoothedPath> ParticleSlam::smoothed() const {
  if (!smoother_) return std::nullopt;
  std::vector<Pose2> poses;
  for (const PathPose& pose : particles_.path().poses) poses.push_back(pose.pose);
  return smoother_->smooth(poses, filtered_map());
}

LandmarkMap ParticleSlam::map() const {
  const auto smooth = smoothed();
  return smooth ? smooth->map : filtered_map();
}

LandmarkMap ParticleSlam::filtered_map() const {
  LandmarkMap result{particles_.estimate().stamp, {}};
  const std::size_t best = particles_.best();
  for (const ContourLandmark& landmark : contours_[best]) result.landmarks.push_back(landmark.estimate());
  for (std::size_t k = 0; k < points_.maps().size(best); ++k) {
    result.landmarks.push_back(points_.maps().at(best, k).estimate());
  }
  return result;
}

}  // namespace noctule::filters
