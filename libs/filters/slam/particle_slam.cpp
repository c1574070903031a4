#include "filters/slam/particle_slam.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/check.hpp"
#include "core/error.hpp"
#include "filters/checks.hpp"
#include "particle/parallel.hpp"
#include "particle/pose_apf.hpp"

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
      poses_(checked_size(parameters, start), start),
      maps_(poses_.size()),
      weights_(poses_.size()),
      paths_(poses_.size()) {
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
  const ContourObservation observation(scan, features, stop_, next_id_, parameters_);
  next_id_ -= static_cast<std::int64_t>(features.features.size());
  observe(scan.stamp, [&](const Pose2& base, Map& map, std::vector<char>& scratch) {
    return observation.apply(base, map.contours, scratch);
  });
}

void ParticleSlam::update(const LandmarkDetections& detections) {
  check(detections);
  check_order("landmark detections", detections.stamp, last_detections_);
  last_detections_ = detections.stamp.seq;

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
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    poses_[i] = poses_[i] * sample(Rng(seed_, stream_id("particle_slam.motion"), step_, static_cast<std::uint32_t>(i)));
  }
  proposal_.reset();
}

template <class Apply>
void ParticleSlam::observe(const Stamp& stamp, Apply apply) {
  std::vector<ObservationFit> fits(poses_.size());
  particle::for_blocks(poses_.size(), parameters_.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<char> scratch;
    for (std::size_t i = begin; i < end; ++i) fits[i] = apply(poses_[i], maps_[i], scratch);
  });

  std::vector<double> log_likelihoods(fits.size());
  std::ranges::transform(fits, log_likelihoods.begin(), &ObservationFit::log_likelihood);
  weights_.multiply(log_likelihoods);
  for (std::size_t i = 0; i < poses_.size(); ++i) paths_.append(i, {stamp.seq, stamp.utime, poses_[i]});

  const std::vector<double> weights = weights_.linear();
  best_ = static_cast<std::size_t>(std::ranges::max_element(weights) - weights.begin());
  note_estimate(stamp, weights, fits);
  estimate_.resampled = estimate_.effective_sample_size < parameters_.resample_below * parameters_.particles;
  if (estimate_.resampled) resample(weights);
  estimate_.distinct_ancestors = static_cast<int>(paths_.distinct_founders());
  ++step_;
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
  std::vector<double> copy_weights(n);
  Rng rng(seed_, stream_id("particle_slam.resampling"), step_);
  resampler_->offspring(weights, static_cast<std::uint32_t>(n), rng, counts, copy_weights);
  const particle::Spread before(particle::pose_states(std::span<const Pose2>(poses_)), weights);
  particle::place_in_slots(counts, ancestors);
  // Survivors keep their slots, so that none is overwritten before it is copied.
  for (std::size_t i = 0; i < n; ++i) {
    if (ancestors[i] == i) continue;
    poses_[i] = poses_[ancestors[i]];
    maps_[i] = maps_[ancestors[i]];
  }
  if (parameters_.resampling == particle::Resampling::regularised) {
    particle::regularise(before, particle::pose_states(std::span<Pose2>(poses_)), rng);
  }
  paths_.resample(ancestors);
  if (resampler_->equal_weights()) {
    weights_.make_uniform();
  } else {
    weights_.inherit(ancestors, copy_weights);
  }
  if (counts[best_] == 0) {
    for (std::size_t i = 0; i < n; ++i) {
      if (counts[i] > 0 && (counts[best_] == 0 || weights[i] > weights[best_])) best_ = i;
    }
  }
  estimate_.distinct_particles = static_cast<int>(n - static_cast<std::size_t>(std::ranges::count(counts, 0u)));
}

PathEstimate ParticleSlam::path() const {
  return {estimate_.stamp, paths_.history(best_)};
}

LandmarkMap ParticleSlam::map() const {
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
