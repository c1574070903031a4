#pragma once
/// The innermost steps of the landmark filters, for one particle at a time. Included by the source files of filters
/// only.
#include <cstdint>
#include <span>

#include "core/gaussian.hpp"
#include "filters/slam/landmark_slam.hpp"

namespace noctule::filters {

/// What a particle sees: its map, and what each sighting is of.
struct ParticleView {
  const LandmarkScan& scan;
  std::span<const std::int32_t> slots;
  LandmarkMaps& maps;
  std::size_t particle;
  double log_new_density;

  /// Whether the k-th sighting is of a landmark that was in the map before this scan.
  [[nodiscard]] bool is_known(std::size_t k, std::size_t size_before) const {
    return slots[k] >= 0 && static_cast<std::size_t>(slots[k]) < size_before;
  }
  [[nodiscard]] const PointLandmark& landmark(std::size_t k) const {
    return maps.at(particle, static_cast<std::size_t>(slots[k]));
  }
};

/// Sum of log N(v; 0, S) of independent innovations of two numbers; takes one logarithm for many.
class LogDensity {
 public:
  void multiply(const InnovationCovariance& s) {
    ++count_;
    distance2_ += s.distance2;
    determinant_ *= s.distance2 < std::numeric_limits<double>::infinity() ? s.determinant : 1.0;
    if (determinant_ < 1e-150 || determinant_ > 1e150) {
      log_determinant_ += std::log(determinant_);
      determinant_ = 1.0;
    }
  }
  /// The fit of these innovations and of `free` sightings that found no landmark.
  [[nodiscard]] ObservationFit fit(int free, double log_new_density) const {
    const double log_determinant = log_determinant_ + (count_ > 0 ? std::log(determinant_) : 0.0);
    return {-0.5 * (distance2_ + log_determinant) - count_ * std::log(kTwoPi) + free * log_new_density, distance2_,
            2 * count_};
  }

 private:
  int count_ = 0;
  double distance2_ = 0.0, determinant_ = 1.0, log_determinant_ = 0.0;
};

/// Landmarks by extended Kalman filters.
struct KalmanUpdate {
  static void update(PointLandmark& m, const Sighting& z, const Pose2& sensor, LogDensity& density) {
    const Innovation v = innovation(z, sensor, m.x, m.y);
    const CrossCovariance c = cross_covariance(m, v);
    const InnovationCovariance s = innovation_covariance(z, v, c);
    density.multiply(s);
    filters::take_in(m, v, c, s);
  }
  [[nodiscard]] static PointLandmark start(const Sighting& z, const Pose2& sensor) { return start_landmark(z, sensor); }
};

/// Takes the sightings into the map of a particle, its pose taken as known.
/// \return what they say of that pose, given the map before
template <class Update>
ObservationFit update_map(const ParticleView& view, const Pose2& pose, const Update& update) {
  const Pose2 sensor = pose * view.scan.sensor_in_base;
  LogDensity density;
  int free = 0;
  for (std::size_t k = 0; k < view.slots.size(); ++k) {
    const Sighting& z = view.scan.sightings[k];
    if (view.slots[k] == kDropped) {
      ++free;
    } else if (const auto slot = static_cast<std::size_t>(view.slots[k]); slot >= view.maps.size(view.particle)) {
      view.maps.append(view.particle, update.start(z, sensor));
      ++free;
    } else {
      update.update(view.maps.writable(view.particle, slot), z, sensor, density);
    }
  }
  return density.fit(free, view.log_new_density);
}

/// Gaussian of a particle's motion, in the frame of its pose before, and how well it explains the scan.
struct MotionPosterior {
  Vector3 mean;
  Matrix3 covariance;
  ObservationFit fit;
};

[[nodiscard]] inline Pose2 draw_motion(const MotionPosterior& q, Rng& rng) {
  const Vector3 drawn = q.mean + sample_gaussian<3>(semidefinite_cholesky<3>(q.covariance), rng);
  return {drawn[0], drawn[1], drawn[2]};
}

}  // namespace noctule::filters
