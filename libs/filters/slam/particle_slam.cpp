#include "filters/slam/particle_slam.hpp"

#include <algorithm>
#include <cmath>
#include <string>

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

void check_order(const char* what, const Stamp& stamp, std::optional<std::int64_t> last) {
  if (!last || stamp.seq > *last) return;
  throw InputError(std::string(what) + ": seq: expected a number above " + std::to_string(*last) +
                   " (every reading enters once), got " + std::to_string(stamp.seq));
}

}  // namespace

ParticleSlam::ParticleSlam(const ParticleSlamParameters& parameters, std::uint64_t seed, const Pose2& start)
    : parameters_(parameters),
      seed_(seed),
      resampler_(particle::make_resampler(parameters.resampling)),
      noise_(parameters.noise),
      poses_(checked_size(parameters, start), start),
      maps_(poses_.size()),
      weights_(poses_.size()),
      paths_(poses_.size()) {
  if (parameters.smooth_path == SmoothPath::all) {
    smoother_.emplace(parameters.path_smoother, parameters.echo, parameters.contour_landmarks.point_radius_sd, start);
  }
  estimate_.pose = start;
  estimate_.particles = estimate_.distinct_particles = estimate_.distinct_ancestors = parameters.particles;
  estimate_.effective_sample_size = parameters.particles;
}

void ParticleSlam::predict(const Odometry& odometry) {
  check(odometry);
  proposal_.add(odometry);
}

void ParticleSlam::update(const UltrasonicScan& scan, const ContourFeatures& features) {
  check(scan);
  check(features, scan);
  check_order("ultrasonic scan", scan.stamp, last_scan_);
  last_scan_ = scan.stamp.seq;

  move_particles();
  const auto echoes = static_cast<std::size_t>(
      std::ranges::count(scan.beams, Echo::hit, [](const UltrasonicBeam& beam) { return beam.echo; }));
  noise_.begin(echoes);
  const ContourObservation observation(scan, features, stop_, next_id_, parameters_,
                                       noise_.adapts() ? &noise_.mixture() : nullptr);
  next_id_ -= static_cast<std::int64_t>(features.features.size());
  const std::size_t kept = noise_.adapts() ? echoes : 0;
  residuals_.resize(kept * poses_.size());
  observe(
      scan.stamp,
      [&](std::size_t i, std::vector<char>& scratch) {
        return observation.apply(poses_[i], maps_[i].contours, scratch, std::span(residuals_).subspan(i * kept, kept));
      },
      [&](std::span<const double> weights) { learn_noise(kept, weights); });
  if (smoother_) smoother_->add(scan, noise_.mixture());
}

void ParticleSlam::update(const LandmarkDetections& detections) {
  check(detections);
  check_order("landmark detections", detections.stamp, last_detections_);
  last_detections_ = detections.stamp.seq;

  move_particles();
  const std::int64_t first_id = next_id_;
  next_id_ -= static_cast<std::int64_t>(detections.detections.size());
  observe(
      detections.stamp,
      [&](std::size_t i, std::vector<char>&) {
        return apply_sightings(detections, poses_[i], first_id, parameters_.sightings, maps_[i].points);
      },
      [](std::span<const double>) {});
}

void ParticleSlam::move_particles() {
  const PoseGaussian& motion = proposal_.motion();
  way_from_stop_ += motion.mean.position().norm();
  if (way_from_stop_ >= parameters_.contour_landmarks.stop_distance) {
    ++stop_;
    way_from_stop_ = 0.0;
  }
  const OdometryProposal::Sampler sample(motion);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    poses_[i] = poses_[i] * sample(Rng(seed_, stream_id("particle_slam.motion"), step_, static_cast<std::uint32_t>(i)));
  }
  if (smoother_) smoother_->add_node(motion);
  proposal_.reset();
}

template <class Apply, class Learn>
void ParticleSlam::observe(const Stamp& stamp, Apply apply, Learn learn) {
  std::vector<ObservationFit> fits(poses_.size());
  particle::for_blocks(poses_.size(), parameters_.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<char> scratch;
    for (std::size_t i = begin; i < end; ++i) fits[i] = apply(i, scratch);
  });

  std::vector<double> log_likelihoods(fits.size());
  std::ranges::transform(fits, log_likelihoods.begin(), &ObservationFit::log_likelihood);
  weights_.multiply(log_likelihoods);
  for (std::size_t i = 0; i < poses_.size(); ++i) paths_.append(i, {stamp.seq, stamp.utime, poses_[i]});

  const std::vector<double> weights = weights_.linear();
  best_ = static_cast<std::size_t>(std::ranges::max_element(weights) - weights.begin());
  learn(weights);
  note_estimate(stamp, weights, fits);
  estimate_.resampled = estimate_.effective_sample_size < parameters_.resample_below * parameters_.particles;
  if (estimate_.resampled) resample(weights);
  estimate_.distinct_ancestors = static_cast<int>(paths_.distinct_founders());
  ++step_;
}

void ParticleSlam::learn_noise(std::size_t echoes, std::span<const double> weights) {
  learned_.clear();
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
  estimate_.noise_scale = std::sqrt(noise / heard);
}

void ParticleSlam::note_estimate(const Stamp& stamp, std::span<const double> weights,
                                 std::span<const ObservationFit> fits) {
  Pose2 mean;
  double cosine = 0.0, sine = 0.0, nis = 0.0, degrees_of_freedom = 0.0;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    mean.x += weights[i] * poses_[i].x;
    mean.y += weights[i] * poses_[i].y;
    cosine += weights[i] * std::cos(poses_[i].yaw);
    sine += weights[i] * std::sin(poses_[i].yaw);
    nis += weights[i] * fits[i].nis;
    degrees_of_freedom += weights[i] * fits[i].degrees_of_freedom;
  }
  mean.yaw = std::atan2(sine, cosine);
  Matrix3 covariance = Matrix3::Zero();
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const Vector3 d = difference(poses_[i], mean);
    covariance += weights[i] * d * d.transpose();
  }
  estimate_.stamp = stamp;
  estimate_.pose = mean;
  estimate_.covariance = covariance;
  estimate_.effective_sample_size = weights_.effective_sample_size();
  estimate_.nis = degrees_of_freedom > 0.0 ? nis / degrees_of_freedom : 0.0;
}

void ParticleSlam::resample(std::span<const double> weights) {
  const std::size_t n = poses_.size();
  std::vector<std::uint32_t> counts(n), ancestors(n);
  Rng rng(seed_, stream_id("particle_slam.resampling"), step_);
  resampler_->offspring(weights, static_cast<std::uint32_t>(n), rng, counts);
  particle::place_in_slots(counts, ancestors);
  // Survivors keep their slots, so that none is overwritten before it is copied.
  for (std::size_t i = 0; i < n; ++i) {
    if (ancestors[i] == i) continue;
    poses_[i] = poses_[ancestors[i]];
    maps_[i] = maps_[ancestors[i]];
  }
  paths_.resample(ancestors);
  weights_.make_uniform();
  if (counts[best_] == 0) {
    for (std::size_t i = 0; i < n; ++i) {
      if (counts[i] > 0 && (counts[best_] == 0 || weights[i] > weights[best_])) best_ = i;
    }
  }
  estimate_.distinct_particles = static_cast<int>(n - static_cast<std::size_t>(std::ranges::count(counts, 0u)));
}

PathEstimate ParticleSlam::path() const {
  PathEstimate path{estimate_.stamp, paths_.history(best_)};
  if (const auto smooth = smoothed()) {
    for (std::size_t k = 0; k < path.poses.size(); ++k) path.poses[k].pose = smooth->poses[k];
  }
  return path;
}

std::optional<SmoothedPath> ParticleSlam::smoothed() const {
  if (!smoother_) return std::nullopt;
  std::vector<Pose2> poses;
  for (const PathPose& pose : paths_.history(best_)) poses.push_back(pose.pose);
  return smoother_->smooth(poses, filtered_map());
}

LandmarkMap ParticleSlam::map() const {
  const auto smooth = smoothed();
  return smooth ? smooth->map : filtered_map();
}

LandmarkMap ParticleSlam::filtered_map() const {
  LandmarkMap result{estimate_.stamp, {}};
  for (const ContourLandmark& landmark : maps_[best_].contours) result.landmarks.push_back(landmark.estimate());
  for (const PointLandmark& point : maps_[best_].points) {
    LandmarkEstimate& e = result.landmarks.emplace_back();
    e.id = point.id;
    e.parameters.head<2>() = point.position;
    e.covariance.topLeftCorner<2, 2>() = point.covariance;
    e.observations = point.observations;
  }
  return result;
}

ParticleCloud ParticleSlam::particles(int at_most) const {
  ParticleCloud cloud{estimate_.stamp, {}};
  const std::vector<double> weights = weights_.linear();
  const auto size = static_cast<std::size_t>(std::max(at_most, 0));
  if (poses_.size() <= size) {
    for (std::size_t i = 0; i < poses_.size(); ++i) cloud.particles.push_back({poses_[i], weights[i]});
    return cloud;
  }
  double cumulative = weights[0];
  for (std::size_t m = 0, i = 0; m < size; ++m) {
    const double tooth = (static_cast<double>(m) + 0.5) / static_cast<double>(size);
    while (cumulative < tooth && i + 1 < weights.size()) cumulative += weights[++i];
    cloud.particles.push_back({poses_[i], 1.0 / static_cast<double>(size)});
  }
  return cloud;
}

}  // namespace noctule::filters
