#include "filters/slam/landmark_slam.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/check.hpp"
#include "core/error.hpp"
#include "core/log_weights.hpp"
#include "filters/checks.hpp"
#include "particle/pose_apf.hpp"

namespace noctule::filters {
namespace {

std::size_t checked_size(const char* name, const LandmarkSlamParameters& parameters, const Pose2& start) {
  require_sound(parameters, name);
  if (!start.finite()) throw InputError(std::string(name) + ": start: expected a finite pose");
  return static_cast<std::size_t>(parameters.particles);
}

}  // namespace

LandmarkSlam::LandmarkSlam(const char* name, const LandmarkSlamParameters& parameters,
                           const OffspringTempering& tempering, std::uint64_t seed, const Pose2& start)
    : parameters_(parameters),
      seed_(seed),
      particles_(checked_size(name, parameters, start), start,
                 {parameters.resampling, parameters.resample_below, tempering}, seed,
                 stream_id("landmark_slam.resampling")),
      points_(particles_.size(), parameters.sightings, parameters.life, parameters.storage, parameters.threads),
      noise_(parameters.noise, particles_.size()),
      fits_(particles_.size()),
      linear_(particles_.size()) {
  if (parameters.optimise == Optimisation::none) return;
  before_ = particles_.poses();
  motions_.resize(before_.size());
  proposals_.resize(before_.size());
}

void LandmarkSlam::predict(const Odometry& odometry) {
  check(odometry);
  add_motion(odometry);
}

void LandmarkSlam::add_motion(const Odometry& odometry) {
  motion_ = motion_ * PoseGaussian{odometry.increment, odometry.covariance};
}

void LandmarkSlam::update(const UltrasonicScan&, const ContourFeatures&) {
  throw InputError("ultrasonic scan: this filter hears nothing; choose type: pf");
}

void LandmarkSlam::update(const LandmarkDetections& detections) {
  check(detections);
  check_order("landmark detections", detections.stamp, last_detections_);
  points_.begin(detections, next_id_);
  noise_.begin(points_.sightings());
  if (detections.detections.empty() && may_wait()) {
    std::ranges::fill(fits_, ObservationFit{});
    particles_.weigh(fits_);
    particles_.record(detections.stamp, fits_, motion_);
    resample();
    return;
  }
  before_association();
  points_.associate(particles_.poses(), motion_);
  observe(detections.stamp);
}

void LandmarkSlam::observe(const Stamp& stamp) {
  if (parameters_.optimise == Optimisation::apf) {
    observe_and_optimise(stamp);
    return;
  }
  points_.make_writable();
  for_particles([this](std::size_t begin, std::size_t end) { take_in(begin, end); });
  points_.live(particles_.poses(), particles_.best(), fits_);
  motion_ = {};
  weigh();
  learn_noise();
  particles_.record(stamp, fits_);
  resample();
}

void LandmarkSlam::weigh() {
  if (parameters_.weight_power != 1.0) {
    for (ObservationFit& fit : fits_) fit.log_likelihood *= parameters_.weight_power;
  }
  particles_.weigh(fits_);
}

/// What was weighed and resampled did not know of the landmarks begun now.
void LandmarkSlam::live_after_weighing() {
  std::ranges::transform(fits_, linear_.begin(), &ObservationFit::log_likelihood);
  if (!points_.live(particles_.poses(), particles_.best(), fits_)) return;
  const auto before = particles_.weights().log();
  for (std::size_t i = 0; i < fits_.size(); ++i) {
    const double gain = std::isfinite(linear_[i]) ? fits_[i].log_likelihood - linear_[i] : 0.0;
    linear_[i] = before[i] + parameters_.weight_power * gain;
  }
  if (log_sum_exp(linear_) > -kInf) particles_.reweigh(linear_);
}

/// Proposal, weights, estimate, resampling, moves, maps: in this order, so that maps fit the poses that go on.
void LandmarkSlam::observe_and_optimise(const Stamp& stamp) {
  for_particles([this](std::size_t begin, std::size_t end) { propose(begin, end); });
  for (std::size_t i = 0; i < motions_.size(); ++i) motions_[i] = between(before_[i], particles_.poses()[i]);
  weigh();
  particles_.record_estimate(stamp, fits_);
  std::span<const particle::MovedParticle> moves;
  const std::uint64_t step = particles_.step();
  const auto ancestors = particles_.resample(&apf_, particle::pose_states(std::span<const Pose2>(motions_)), moves);
  if (!ancestors.empty()) {
    points_.resample(ancestors);
    points_.inherit(ancestors);
    for (std::size_t i = 0; i < ancestors.size(); ++i) {
      if (ancestors[i] != i) fits_[i] = fits_[ancestors[i]];
    }
    move_toward_neighbours(ancestors, step, moves);
  }
  points_.make_writable();
  for_particles([this](std::size_t begin, std::size_t end) { update_maps(begin, end); });
  live_after_weighing();
  learn_noise();
  motion_ = {};
  particles_.record_paths(stamp);
  before_ = particles_.poses();
}

/// What moves is the latest motion, from the pose that the neighbour had before it: pose and map stay one's own. A move
/// is taken like a Metropolis step, so that it does not go where the scan forbids; else the copy of the neighbour
/// stays.
void LandmarkSlam::move_toward_neighbours(std::span<const std::uint32_t> ancestors, std::uint64_t step,
                                          std::span<const particle::MovedParticle> moves) {
  const auto rng_of = [&](std::size_t slot) {
    return Rng(seed_, stream_id("landmark_slam.optimise"), step, static_cast<std::uint32_t>(slot));
  };
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    if (ancestors[i] == i) continue;
    Rng rng = rng_of(i);
    particles_.poses()[i] = before_[ancestors[i]] * another_motion(ancestors[i], rng);
  }
  for (const particle::MovedParticle& move : moves) {
    Pose2 motion;
    particle::apply_move(move, particle::pose_states(std::span<const Pose2>(motions_)), &motion.x);
    const double gain =
        log_density_of_motion(move.toward, motion) - log_density_of_motion(move.toward, motions_[move.toward]);
    Rng rng = rng_of(ancestors.size() + move.slot);
    if (std::log(rng.uniform()) < gain) particles_.poses()[move.slot] = before_[move.toward] * motion;
  }
}

double LandmarkSlam::log_density_of_motion(std::size_t i, const Pose2& motion) {
  return filters::log_density_of_motion(motion, proposals_[i].mean, proposals_[i].covariance);
}

Pose2 LandmarkSlam::another_motion(std::size_t i, Rng& rng) {
  return draw_motion(proposals_[i], rng);
}

double log_density_of_motion(const Pose2& motion, const Vector3& mean, const Matrix3& covariance) {
  const Matrix3 root = semidefinite_cholesky<3>(covariance);
  Vector3 rest(motion.x - mean[0], motion.y - mean[1], wrap(motion.yaw - mean[2]));
  double distance2 = 0.0;
  for (int j = 0; j < 3; ++j) {
    if (!(root(j, j) > 0.0)) continue;
    const double place = rest[j] / root(j, j);
    distance2 += place * place;
    rest -= place * root.col(j);
  }
  return -0.5 * distance2;
}

void LandmarkSlam::learn_noise() {
  if (!noise_.learns()) return;
  particles_.weights().linear(linear_);
  noise_.learn(linear_);
}

SlamEstimate LandmarkSlam::estimate() const {
  SlamEstimate estimate = particles_.estimate();
  estimate.noise_scale = noise_.scale();
  return estimate;
}

std::span<const std::uint32_t> LandmarkSlam::resample() {
  const auto ancestors = particles_.resample();
  if (!ancestors.empty()) points_.resample(ancestors);
  if (!ancestors.empty() && !before_.empty()) before_ = particles_.poses();
  return ancestors;
}

void LandmarkSlam::begin_on(const LandmarkMap& map, const ParticleCloud& poses) {
  particles_.spread(poses);
  if (!before_.empty()) before_ = particles_.poses();
  points_.begin_on(point_landmarks(map), next_id_);
}

void LandmarkSlam::transfer(StateArchive& archive) {
  archive(particles_, points_, motion_, next_id_, last_detections_, noise_);
  archive.each(before_, Pose2{}, [&](Pose2& pose) { archive(pose); });
  if (particles_.poses().size() != fits_.size()) throw InputError("state: expected that of as many particles");
}

LandmarkMap LandmarkSlam::map() const {
  const SlamEstimate& now = particles_.estimate();
  LandmarkMap result{now.stamp, {}};
  const LandmarkMaps& maps = points_.maps();
  const std::size_t best = particles_.best();
  std::vector<double> weights;
  if (parameters_.map == ReportedMap::mean) weights = particles_.weights().linear();
  for (std::size_t k = 0; k < maps.size(best); ++k) {
    const PointLandmark& m = maps.at(best, k);
    if (!points_.is_confirmed(m)) continue;
    LandmarkEstimate e = m.estimate();
    if (parameters_.map == ReportedMap::mean) {
      // Over the particles that have it: descendants of those that started it keep its name.
      double total = 0.0;
      Vector2 sum = Vector2::Zero();
      Matrix2 second = Matrix2::Zero();
      for (std::size_t i = 0; i < particles_.size(); ++i) {
        for (std::size_t j = 0; j < maps.size(i); ++j) {
          const std::size_t slot = (k + j) % maps.size(i);  // usually the first one
          const PointLandmark& other = maps.at(i, slot);
          if (other.id != m.id) continue;
          const Vector2 off = other.position() - m.position();
          total += weights[i];
          sum += weights[i] * off;
          second += weights[i] * (other.covariance() + off * off.transpose());
          break;
        }
      }
      if (total > 0.0) {
        const Vector2 mean = sum / total;
        e.parameters.head<2>() += mean;
        e.covariance.topLeftCorner<2, 2>() = second / total - mean * mean.transpose();
      }
    }
    result.landmarks.push_back(e);
  }
  return result;
}

}  // namespace noctule::filters
