#pragma once
/// The innermost steps of the landmark filters, for one particle at a time. Included by the source files of filters
/// only.
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/gaussian.hpp"
#include "filters/slam/landmark_slam.hpp"
#include "filters/slam/sighting_noise.hpp"

namespace noctule::filters {

/// Sum of log N(v; 0, S) of independent innovations of two numbers; takes one logarithm for many.
class LogDensity {
 public:
  void multiply(const InnovationCovariance& s) { multiply(s.distance2, s.determinant); }
  void multiply(double distance2, double determinant) {
    ++count_;
    distance2_ += distance2;
    determinant_ *= distance2 < kInf ? determinant : 1.0;
    if (determinant_ < 1e-150 || determinant_ > 1e150) {
      log_determinant_ += std::log(determinant_);
      determinant_ = 1.0;
    }
  }
  /// An innovation of two numbers of any density.
  void add(double log_density, double nis) {
    ++added_;
    log_density_ += log_density;
    nis_ += nis;
  }
  /// The fit of these innovations and of `free` sightings that found no landmark.
  [[nodiscard]] ObservationFit fit(int free, double log_new_density) const {
    const double log_determinant = log_determinant_ + (count_ > 0 ? std::log(determinant_) : 0.0);
    return {-0.5 * (distance2_ + log_determinant) - count_ * std::log(kTwoPi) + free * log_new_density + log_density_,
            distance2_ + nis_, 2 * (count_ + added_)};
  }

 private:
  int count_ = 0, added_ = 0;
  double log_density_ = 0.0, nis_ = 0.0;
  double distance2_ = 0.0, determinant_ = 1.0, log_determinant_ = 0.0;
};

/// What an update does with an innovation: how probable it is goes into `density`.
/// \param expected covariance of the prediction, without noise
/// \return covariance of the noise
inline SightingCovariance weigh(const StatedNoise&, const Sighting& z, const Innovation& v,
                                const SightingCovariance& expected, LogDensity& density) {
  density.multiply(InnovationCovariance(expected.rr + z.rr, expected.rb + z.rb, expected.bb + z.bb, v));
  return {z.rr, z.rb, z.bb};
}
/// \param[in,out] v what noise of a known mean leaves of it
inline SightingCovariance weigh(const LearnedNoise& learned, const Sighting& z, Innovation& v,
                                const SightingCovariance& expected, LogDensity& density) {
  const auto judged = learned.noise.judge(z, v, expected);
  density.add(judged.log_density, judged.nis);
  v.range -= judged.range;
  v.bearing -= judged.bearing;
  return judged.noise;
}

/// H P H' of a landmark.
[[nodiscard]] inline SightingCovariance expected_covariance(const Innovation& v, const CrossCovariance<double>& c) {
  return {v.ux * c.xr + v.uy * c.yr, v.ux * c.xb + v.uy * c.yb, v.inverse_range * (v.ux * c.yb - v.uy * c.xb)};
}

/// Landmarks by extended Kalman filters.
template <class Noise = StatedNoise>
struct KalmanUpdate {
  Noise noise;

  void update(PointLandmark& m, const Sighting& z, const Pose2& sensor, LogDensity& density) const {
    Innovation v = innovation<double>(z, sensor, m.x, m.y);
    const auto c = cross_covariance<double>(m, v);
    const SightingCovariance p = expected_covariance(v, c);
    const SightingCovariance r = weigh(noise, z, v, p, density);
    filters::take_in(m, v, c, InnovationCovariance(p.rr + r.rr, p.rb + r.rb, p.bb + r.bb, v));
  }
  /// Two different landmarks at a time.
  static void update(PointLandmark& a, PointLandmark& b, const Sighting& za, const Sighting& zb, const Pose2& sensor,
                     LogDensity& density) requires(std::is_same_v<Noise, StatedNoise>) {
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

/// What the sightings say of the pose of a particle; nothing changes.
template <class Noise>
ObservationFit weigh_pose(const ParticleView& view, const Pose2& pose, const Noise& noise) {
  const Pose2 sensor = sensor_pose(pose, view.scan.sensor_in_base);
  const std::size_t known = view.maps.size(view.particle);
  LogDensity density;
  int free = 0;
  for (std::size_t k = 0; k < view.slots.size(); ++k) {
    if (!view.is_known(k, known)) {
      ++free;
      continue;
    }
    const Sighting& z = view.scan.sightings[k];
    const PointLandmark& m = view.landmark(k);
    Innovation v = innovation<double>(z, sensor, m.x, m.y);
    weigh(noise, z, v, expected_covariance(v, cross_covariance<double>(m, v)), density);
  }
  return density.fit(free, view.log_new_density);
}

/// Takes the sightings into the map of a particle, its pose taken as known.
/// \return what they say of that pose, given the map before
template <class Update>
ObservationFit update_map(const ParticleView& view, const Pose2& pose, const Update& update) {
  constexpr bool in_pairs = requires(PointLandmark & m, const Sighting& z, LogDensity& d) {
    update.update(m, m, z, z, pose, d);
  };
  const Pose2 sensor = sensor_pose(pose, view.scan.sensor_in_base);
  const auto& sightings = view.scan.sightings;
  const std::size_t known = view.maps.size(view.particle);
  LogDensity density;
  int free = 0;
  for (std::size_t k = 0; k < view.slots.size(); ++k) {
    const std::size_t size = view.maps.size(view.particle);
    if (view.slots[k] == kDropped) {
      ++free;
      continue;
    }
    const auto slot = static_cast<std::size_t>(view.slots[k]);
    if (slot >= size) {
      view.maps.append(view.particle, update.start(sightings[k], sensor));
      ++free;
      continue;
    }
    PointLandmark& m = view.maps.writable(view.particle, slot);
    if constexpr (in_pairs) {
      if (k + 1 < view.slots.size() && view.is_known(k + 1, size) && view.slots[k + 1] != view.slots[k]) {
        PointLandmark& next = view.maps.writable(view.particle, static_cast<std::size_t>(view.slots[k + 1]));
        update.update(m, next, sightings[k], sightings[k + 1], sensor, density);
        ++k;
        continue;
      }
    }
    update.update(m, sightings[k], sensor, density);
  }
  update.noise.note(view, pose, known);
  return density.fit(free, view.log_new_density);
}

}  // namespace noctule::filters
