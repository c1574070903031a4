#include "filters/slam/landmark_slam.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/check.hpp"
#include "core/error.hpp"
#include "filters/checks.hpp"

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
      fits_(particles_.size()) {}

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
  points_.make_writable();
  for_particles([this](std::size_t begin, std::size_t end) { take_in(begin, end); });
  points_.live(particles_.poses(), particles_.best(), fits_);
  motion_ = {};
  particles_.weigh(fits_);
  particles_.record(stamp, fits_);
  resample();
}

std::span<const std::uint32_t> LandmarkSlam::resample() {
  const auto ancestors = particles_.resample();
  if (!ancestors.empty()) points_.resample(ancestors);
  return ancestors;
}

void LandmarkSlam::begin_on(const LandmarkMap& map, const ParticleCloud& poses) {
  particles_.spread(poses);
  points_.begin_on(point_landmarks(map), next_id_);
}

void LandmarkSlam::transfer(StateArchive& archive) {
  archive(particles_, points_, motion_, next_id_, last_detections_);
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
