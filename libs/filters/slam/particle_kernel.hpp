#pragma once
/// The innermost steps of the landmark filters, for one particle at a time. Included by the source files of filters
/// only.
#include <cstdint>
#include <span>

#include "core/gaussian.hpp"
#include "filters/slam/path_particles.hpp"
#include "filters/slam/point_maps.hpp"

namespace noctule::filters {

/// Sum of log N(v; 0, S) of independent innovations; takes one logarithm for many.
class LogDensity {
 public:
  void multiply(const InnovationCovariance& s, const Sighting& z) { multiply(s.distance2, s.determinant, z.numbers()); }
  /// \param numbers of the innovation
  void multiply(double distance2, double determinant, int numbers = 2) {
    numbers_ += numbers;
    distance2_ += distance2;
    determinant_ *= distance2 < kInf ? determinant : 1.0;
    if (determinant_ < 1e-150 || determinant_ > 1e150) {
      log_determinant_ += std::log(determinant_);
      determinant_ = 1.0;
    }
  }
  /// The fit of these innovations and of sightings that found no landmark, of log density `log_free`.
  [[nodiscard]] ObservationFit fit(double log_free) const {
    const double log_determinant = log_determinant_ + (numbers_ > 0 ? std::log(determinant_) : 0.0);
    return {-0.5 * (distance2_ + log_determinant + numbers_ * std::log(kTwoPi)) + log_free, distance2_, numbers_};
  }

 private:
  int numbers_ = 0;
  double distance2_ = 0.0, determinant_ = 1.0, log_determinant_ = 0.0;
};

/// Landmarks by extended Kalman filters.
struct KalmanUpdate {
  static void update(PointLandmark& m, const Sighting& z, const Pose2& sensor, LogDensity& density) {
    const PredictedSighting p(m, z, sensor);
    density.multiply(p.s, z);
    filters::take_in(m, p.v, p.c, p.s);
  }
  /// Two different landmarks at a time.
  static void update(PointLandmark& a, PointLandmark& b, const Sighting& za, const Sighting& zb, const Pose2& sensor,
                     LogDensity& density) {
    LandmarkState<Pair> m{{a.x, b.x}, {a.y, b.y}, {a.xx, b.xx}, {a.xy, b.xy}, {a.yy, b.yy}};
    const RangeBearing<Pair> z{
        {za.range, zb.range}, {za.bearing, zb.bearing}, {za.rr, zb.rr}, {za.rb, zb.rb}, {za.bb, zb.bb}};
    const auto v = innovation(z, sensor, m.x, m.y);
    const auto c = cross_covariance(m, v);
    const auto s = innovation_covariance(z, v, c);
    assimilate(m, v, c, s);
    PointLandmark* const landmarks[] = {&a, &b};
    for (int i = 0; i < 2; ++i) {
      density.multiply(s.distance2[i], s.determinant[i]);
      if (!(s.distance2[i] < kInf)) continue;
      static_cast<LandmarkState<double>&>(*landmarks[i]) = {m.x[i], m.y[i], m.xx[i], m.xy[i], m.yy[i]};
      ++landmarks[i]->observations;
    }
  }
  [[nodiscard]] static PointLandmark start(const Sighting& z, const Pose2& sensor) { return start_landmark(z, sensor); }
};

/// Takes the sightings into the map of a particle, its pose taken as known.
/// \return what they say of that pose, given the map before
template <class Update>
ObservationFit update_map(const ParticleView& view, const Pose2& pose, const Update& update) {
  constexpr bool in_pairs = requires(PointLandmark & m, const Sighting& z, LogDensity& d) {
    update.update(m, m, z, z, pose, d);
  };
  const Pose2 sensor = sensor_pose(pose, view.scan.sensor_in_base);
  const auto& sightings = view.scan.sightings;
  LogDensity density;
  double log_free = 0.0;
  for (std::size_t k = 0; k < view.slots.size(); ++k) {
    const std::size_t size = view.maps.size(view.particle);
    if (view.slots[k] < 0) {
      log_free += view.log_new(k);
      continue;
    }
    const auto slot = static_cast<std::size_t>(view.slots[k]);
    if (slot >= size) {
      view.maps.append(view.particle, update.start(sightings[k], sensor));
      log_free += view.log_new(k);
      continue;
    }
    PointLandmark& m = view.maps.writable(view.particle, slot);
    if constexpr (in_pairs) {
      if (k + 1 < view.slots.size() && view.is_known(k + 1, size) && view.slots[k + 1] != view.slots[k] &&
          sightings[k].is_whole() && sightings[k + 1].is_whole()) {
        PointLandmark& next = view.maps.writable(view.particle, static_cast<std::size_t>(view.slots[k + 1]));
        update.update(m, next, sightings[k], sightings[k + 1], sensor, density);
        ++k;
        continue;
      }
    }
    update.update(m, sightings[k], sensor, density);
  }
  return density.fit(log_free);
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
