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
  /// An innovation of two numbers of any density.
  void add(double log_density, double nis) {
    added_ += 2;
    log_density_ += log_density;
    nis_ += nis;
  }
  /// The fit of these innovations and of sightings that found no landmark, of log density `log_free`.
  [[nodiscard]] ObservationFit fit(double log_free) const {
    const double log_determinant = log_determinant_ + (numbers_ > 0 ? std::log(determinant_) : 0.0);
    return {-0.5 * (distance2_ + log_determinant + numbers_ * std::log(kTwoPi)) + log_free + log_density_,
            distance2_ + nis_, numbers_ + added_};
  }

 private:
  int numbers_ = 0, added_ = 0;
  double log_density_ = 0.0, nis_ = 0.0;
  double distance2_ = 0.0, determinant_ = 1.0, log_determinant_ = 0.0;
};

/// What an update does with an innovation: how probable it is goes into `density`.
/// \param s its covariance with the noise that the sighting has
/// \return its covariance with the noise that is believed given the innovation
inline InnovationCovariance weigh(const StatedNoise&, const Sighting& z, const Innovation&,
                                  const InnovationCovariance& s, LogDensity& density) {
  density.multiply(s, z);
  return s;
}
/// \param[in,out] v what noise of a known mean leaves of it
inline InnovationCovariance weigh(const LearnedNoise& learned, const Sighting& z, Innovation& v,
                                  const InnovationCovariance& s, LogDensity& density) {
  if (!z.is_whole()) return weigh(StatedNoise{}, z, v, s, density);
  const SightingCovariance expected{s.rr - z.rr, s.rb - z.rb, s.bb - z.bb};
  const auto judged = learned.noise.judge(z, v, expected);
  density.add(judged.log_density, judged.nis);
  v.range -= judged.range;
  v.bearing -= judged.bearing;
  const SightingCovariance& r = judged.noise;
  return {expected.rr + r.rr, expected.rb + r.rb, expected.bb + r.bb, v};
}

/// Landmarks by extended Kalman filters.
template <class Noise = StatedNoise>
struct KalmanUpdate {
  Noise noise;

  void update(PointLandmark& m, const Sighting& z, const Pose2& sensor, LogDensity& density) const {
    const PredictedSighting p(m, z, sensor);
    Innovation v = p.v;
    const InnovationCovariance s = weigh(noise, z, v, p.s, density);
    filters::take_in(m, v, p.c, s);
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
  double log_free = 0.0;
  for (std::size_t k = 0; k < view.slots.size(); ++k) {
    if (!view.is_known(k, known)) {
      log_free += view.log_new(k);
      continue;
    }
    const Sighting& z = view.scan.sightings[k];
    const PredictedSighting p(view.landmark(k), z, sensor);
    Innovation v = p.v;
    weigh(noise, z, v, p.s, density);
  }
  return density.fit(log_free);
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
  update.noise.note(view, pose, known);
  return density.fit(log_free);
}

}  // namespace noctule::filters
