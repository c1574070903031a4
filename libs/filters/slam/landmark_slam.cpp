#include "filters/slam/landmark_slam.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/check.hpp"
#include "core/error.hpp"
#include "filters/checks.hpp"
#include "particle/parallel.hpp"

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
      log_new_density_(std::log(parameters.sightings.new_density)),
      particles_(checked_size(name, parameters, start), start,
                 {parameters.resampling, parameters.resample_below, tempering}, seed,
                 stream_id("landmark_slam.resampling")),
      maps_(particles_.size(), parameters.storage),
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
  prepare(detections);
  if (scan_.sightings.empty() && may_wait()) {
    std::ranges::fill(fits_, ObservationFit{});
    particles_.weigh(fits_);
    particles_.record(detections.stamp, fits_, motion_);
    resample();
    return;
  }
  before_association();
  associate_all();
  observe(detections.stamp);
}

/// Named sightings come first and in the order of their names, so that no result depends on how they were sent.
void LandmarkSlam::prepare(const LandmarkDetections& detections) {
  scan_.sensor_in_base = detections.sensor_in_base;
  scan_.sightings.clear();
  for (const LandmarkDetection& d : detections.detections) {
    Sighting& z = scan_.sightings.emplace_back();
    z.range = d.range;
    z.bearing = wrap(d.bearing);
    z.rr = d.covariance(0, 0);
    z.rb = d.covariance(0, 1);
    z.bb = d.covariance(1, 1);
    z.id = d.id;
    z.new_id = next_id_--;
  }
  // Insertion sort: stable, and allocates nothing.
  auto& sightings = scan_.sightings;
  const auto before = [](const Sighting& a, const Sighting& b) { return a.id >= 0 && (b.id < 0 || a.id < b.id); };
  for (std::size_t k = 1; k < sightings.size(); ++k) {
    for (std::size_t j = k; j > 0 && before(sightings[j], sightings[j - 1]); --j) {
      std::swap(sightings[j], sightings[j - 1]);
    }
  }
}

void LandmarkSlam::associate_all() {
  const bool named = scan_.sightings.empty() || scan_.sightings.back().id >= 0;
  shared_identity_ &= named;
  const std::size_t width = scan_.sightings.size();
  slots_.resize(shared_identity_ ? width : width * particles_.size());
  if (shared_identity_) {
    find_named();
    return;
  }
  for_particles([this](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      associate(scan_, {particles_.poses()[i], motion_}, maps_, i, parameters_.sightings,
                {slots_.data() + i * scan_.sightings.size(), scan_.sightings.size()});
    }
  });
}

void LandmarkSlam::find_named() {
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    slots_[k] = slot_of_.try_emplace(scan_.sightings[k].id, static_cast<std::int32_t>(slot_of_.size())).first->second;
  }
}

void LandmarkSlam::for_particles(const std::function<void(std::size_t, std::size_t)>& body) {
  particle::for_blocks(particles_.size(), parameters_.threads, body);
}

void LandmarkSlam::make_landmarks_writable() {
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const auto mine = slots(i);
    const auto size = static_cast<std::int32_t>(maps_.size(i));
    maps_.own(i, mine);
    const std::int32_t last = mine.empty() ? kDropped : *std::ranges::max_element(mine);
    if (last >= size) maps_.reserve(i, static_cast<std::size_t>(last - size + 1));
  }
  maps_.copy_pages(parameters_.threads);
}

void LandmarkSlam::observe(const Stamp& stamp) {
  make_landmarks_writable();
  for_particles([this](std::size_t begin, std::size_t end) { take_in(begin, end); });
  motion_ = {};
  particles_.weigh(fits_);
  particles_.record(stamp, fits_);
  resample();
}

std::span<const std::uint32_t> LandmarkSlam::resample() {
  const auto ancestors = particles_.resample();
  if (!ancestors.empty()) maps_.resample(ancestors);
  return ancestors;
}

void LandmarkSlam::inherit_slots(std::span<const std::uint32_t> ancestors) {
  if (shared_identity_) return;
  const std::size_t width = scan_.sightings.size();
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    if (ancestors[i] != i) std::copy_n(slots_.data() + ancestors[i] * width, width, slots_.data() + i * width);
  }
}

LandmarkMap LandmarkSlam::map() const {
  const SlamEstimate& now = particles_.estimate();
  LandmarkMap result{now.stamp, {}};
  const std::size_t best = particles_.best();
  const std::vector<double> weights = particles_.weights().linear();
  for (std::size_t k = 0; k < maps_.size(best); ++k) {
    const PointLandmark& m = maps_.at(best, k);
    if (parameters_.life && m.id < 0 && m.existence < parameters_.life->confirm_above) continue;
    LandmarkEstimate e = m.estimate();
    if (parameters_.map == ReportedMap::mean) {
      // Over the particles that have it: descendants of those that started it keep its name.
      double total = 0.0;
      Vector2 sum = Vector2::Zero();
      Matrix2 second = Matrix2::Zero();
      for (std::size_t i = 0; i < particles_.size(); ++i) {
        for (std::size_t j = 0; j < maps_.size(i); ++j) {
          const std::size_t slot = (k + j) % maps_.size(i);  // usually the first one
          const PointLandmark& other = maps_.at(i, slot);
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
