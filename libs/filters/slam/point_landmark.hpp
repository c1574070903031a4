#pragma once
/// A point landmark of one particle and its Kalman filter, conditioned on the particle's pose. Written out in scalars:
/// the innermost loop of every landmark filter. T is double, or Pair for two landmarks at a time.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/estimate.hpp"
#include "core/limits.hpp"
#include "core/observations.hpp"
#include "core/pair.hpp"
#include "core/pose2.hpp"
#include "core/state_archive.hpp"

namespace noctule::filters {

template <class T>
struct LandmarkState {
  T x{}, y{};          ///< map [m]
  T xx{}, xy{}, yy{};  ///< covariance [m^2]
};

struct PointLandmark : LandmarkState<double> {
  std::int64_t id = 0;
  float existence = 0.0f;  ///< log odds
  std::int32_t observations = 0;

  [[nodiscard]] Vector2 position() const { return {x, y}; }
  [[nodiscard]] Matrix2 covariance() const {
    Matrix2 p;
    p << xx, xy, xy, yy;
    return p;
  }
  void set(const Vector2& position, const Matrix2& covariance) {
    x = position.x();
    y = position.y();
    xx = covariance(0, 0);
    xy = covariance(0, 1);
    yy = covariance(1, 1);
  }
  void transfer(StateArchive& archive) { archive(x, y, xx, xy, yy, id, existence, observations); }
  [[nodiscard]] LandmarkEstimate estimate() const {
    LandmarkEstimate e;
    e.id = id;
    e.parameters.head<2>() = position();
    e.covariance.topLeftCorner<2, 2>() = covariance();
    e.observations = observations;
    return e;
  }
};

/// Range [m] and bearing [rad] from the sensor's x axis, with their covariance.
template <class T>
struct RangeBearing {
  T range{}, bearing{};
  T rr{}, rb{}, bb{};
};

/// Inverse of the lower triangular root of a covariance of (range, bearing): what it makes of residuals has covariance
/// I.
struct Whitening {
  double rr = 1.0, br = 0.0, bb = 1.0;
};

/// One sighting of a message, as the particles take it in. What it does not measure is taken as a number of variance 1
/// that comes out as predicted, whatever the state: it adds to no innovation, gain or density. Where the noise is
/// learned the covariance is what the filter believes, else what the sensor states.
struct Sighting : RangeBearing<double> {
  DetectionKind kind = DetectionKind::range_bearing;
  std::int64_t id = -1;     ///< of the landmark, or -1
  std::int64_t new_id = 0;  ///< of the landmark that it may start
  Whitening stated;         ///< by the covariance that the sensor states; set where the noise is learned

  Sighting() = default;
  Sighting(const LandmarkDetection& d, std::int64_t new_name)
      : RangeBearing{d.range, wrap(d.bearing), d.covariance(0, 0), d.covariance(0, 1), d.covariance(1, 1)},
        kind(d.kind),
        id(d.id),
        new_id(new_name) {
    if (is_whole()) return;
    rb = 0.0;
    (kind == DetectionKind::bearing_only ? rr : bb) = 1.0;
  }
  [[nodiscard]] bool is_whole() const { return kind == DetectionKind::range_bearing; }
  void transfer(StateArchive& archive) { archive(range, bearing, rr, rb, bb, kind, id, new_id); }
  /// How many numbers it measures.
  [[nodiscard]] int numbers() const { return is_whole() ? 2 : 1; }
};

/// Innovation of a sighting of a landmark, with what its covariance is made of.
template <class T>
struct BasicInnovation {
  T range, bearing;  ///< measured - predicted [m], [rad]
  T ux, uy;          ///< unit vector from the sensor to the landmark, map
  T inverse_range;   ///< [1/m]; 0 for a landmark on the sensor, where no direction is defined
};
using Innovation = BasicInnovation<double>;

template <class T>
[[nodiscard]] inline BasicInnovation<T> innovation(const RangeBearing<T>& z, const Pose2& sensor, T x, T y) {
  const T dx = x - sensor.x, dy = y - sensor.y;
  const T r = square_root(dx * dx + dy * dy);
  const T one = spread(1.0, r), near = spread(1e-6, r);
  const T inverse = select(r < near, spread(0.0, r), one / select(r < near, one, r));
  return {z.range - r, wrap_near(z.bearing + sensor.yaw - fast_atan2(dy, dx)), inverse * dx, inverse * dy, inverse};
}

/// Covariance S of an innovation (2x2), with the squared Mahalanobis length of the innovation.
template <class T>
struct BasicInnovationCovariance {
  T rr, rb, bb;
  T determinant;
  T distance2;  ///< +inf where S is not positive definite or the innovation beyond all bounds

  BasicInnovationCovariance(T s_rr, T s_rb, T s_bb, const BasicInnovation<T>& v)
      : rr(s_rr), rb(s_rb), bb(s_bb), determinant(s_rr * s_bb - s_rb * s_rb) {
    const T infinity = spread(kInf, s_rr), zero = spread(0.0, s_rr);
    const T d = (v.range * (bb * v.range - rb * v.bearing) + v.bearing * (rr * v.bearing - rb * v.range)) / determinant;
    distance2 = select(determinant > zero, select(d >= zero, d, infinity), infinity);  // NaN: out of bounds
  }
  /// log N(v; 0, S)
  [[nodiscard]] double log_density() const {
    return distance2 < kInf ? -0.5 * (distance2 + std::log(determinant)) - std::log(kTwoPi) : -kInf;
  }
};
using InnovationCovariance = BasicInnovationCovariance<double>;

/// P H' of a landmark with covariance P, column by column (range, bearing).
template <class T>
struct CrossCovariance {
  T xr, yr, xb, yb;
};
template <class T>
[[nodiscard]] inline CrossCovariance<T> cross_covariance(const LandmarkState<T>& m, const BasicInnovation<T>& v) {
  return {m.xx * v.ux + m.xy * v.uy, m.xy * v.ux + m.yy * v.uy, v.inverse_range * (m.xy * v.ux - m.xx * v.uy),
          v.inverse_range * (m.yy * v.ux - m.xy * v.uy)};
}

/// H P H' + R
template <class T>
[[nodiscard]] inline BasicInnovationCovariance<T> innovation_covariance(const RangeBearing<T>& z,
                                                                        const BasicInnovation<T>& v,
                                                                        const CrossCovariance<T>& c) {
  return {v.ux * c.xr + v.uy * c.yr + z.rr, v.ux * c.xb + v.uy * c.yb + z.rb,
          v.inverse_range * (v.ux * c.yb - v.uy * c.xb) + z.bb, v};
}

/// A sighting as it is predicted from a pose taken as known: what it does not measure left out.
struct PredictedSighting {
  Innovation v;
  CrossCovariance<double> c;
  InnovationCovariance s;

  PredictedSighting(const LandmarkState<double>& m, const Sighting& z, const Pose2& sensor)
      : v(innovation<double>(z, sensor, m.x, m.y)),
        c(cross_covariance<double>(m, v)),
        s(innovation_covariance<double>(z, v, c)) {
    if (z.is_whole()) return;
    leave_out(z.kind);
  }

 private:
  void leave_out(DetectionKind kind) {
    if (kind == DetectionKind::bearing_only) {
      v.range = c.xr = c.yr = 0.0;
      s = {1.0, 0.0, s.bb, v};
    } else {
      v.bearing = c.xb = c.yb = 0.0;
      s = {s.rr, 0.0, 1.0, v};
    }
  }
};

/// Kalman update from a pose taken as known. \pre distance2 of s is finite
template <class T>
inline void assimilate(LandmarkState<T>& m, const BasicInnovation<T>& v, const CrossCovariance<T>& c,
                       const BasicInnovationCovariance<T>& s) {
  const T scale = 1.0 / s.determinant;
  const T i_rr = s.bb * scale, i_rb = -s.rb * scale, i_bb = s.rr * scale;
  const T xr = c.xr * i_rr + c.xb * i_rb, xb = c.xr * i_rb + c.xb * i_bb;  // the gain
  const T yr = c.yr * i_rr + c.yb * i_rb, yb = c.yr * i_rb + c.yb * i_bb;
  m.x += xr * v.range + xb * v.bearing;
  m.y += yr * v.range + yb * v.bearing;
  m.xx -= xr * c.xr + xb * c.xb;
  m.xy -= xr * c.yr + xb * c.yb;
  m.yy -= yr * c.yr + yb * c.yb;
}

/// Kalman update from a pose taken as known. An innovation that is impossible teaches nothing.
inline void take_in(PointLandmark& m, const Innovation& v, const CrossCovariance<double>& c,
                    const InnovationCovariance& s) {
  if (!(s.distance2 < kInf)) return;
  assimilate<double>(m, v, c, s);
  ++m.observations;
}

/// The landmark that a sighting starts from a pose taken as known.
[[nodiscard]] inline PointLandmark start_landmark(const Sighting& z, const Pose2& sensor) {
  const double c = std::cos(sensor.yaw + z.bearing), s = std::sin(sensor.yaw + z.bearing);
  const double across = z.range * z.range * z.bb, skew = z.range * z.rb;
  PointLandmark m;
  m.x = sensor.x + z.range * c;
  m.y = sensor.y + z.range * s;
  m.xx = c * c * z.rr - 2.0 * c * s * skew + s * s * across;
  m.xy = c * s * (z.rr - across) + (c * c - s * s) * skew;
  m.yy = s * s * z.rr + 2.0 * c * s * skew + c * c * across;
  m.id = z.id >= 0 ? z.id : z.new_id;
  m.observations = 1;
  return m;
}

}  // namespace noctule::filters
