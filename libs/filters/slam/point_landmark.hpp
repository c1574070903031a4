#pragma once
/// A point landmark of one particle and its Kalman filter, conditioned on the particle's pose. Written out in scalars:
/// the innermost loop of every landmark filter.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/estimate.hpp"
#include "core/pose2.hpp"

namespace noctule::filters {

struct PointLandmark {
  double x = 0.0, y = 0.0;              ///< map [m]
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< covariance [m^2]
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
  [[nodiscard]] LandmarkEstimate estimate() const {
    LandmarkEstimate e;
    e.id = id;
    e.parameters.head<2>() = position();
    e.covariance.topLeftCorner<2, 2>() = covariance();
    e.observations = observations;
    return e;
  }
};

/// One sighting of a message, as the particles take it in.
struct Sighting {
  double range = 0.0, bearing = 0.0;    ///< [m], [rad] from the sensor's x axis
  double rr = 0.0, rb = 0.0, bb = 0.0;  ///< covariance
  std::int64_t id = -1;                 ///< of the landmark, or -1
  std::int64_t new_id = 0;              ///< of the landmark that it may start
};

/// Innovation of a sighting of a landmark, with what its covariance is made of.
struct Innovation {
  double range, bearing;  ///< measured - predicted [m], [rad]
  double ux, uy;          ///< unit vector from the sensor to the landmark, map
  double inverse_range;   ///< [1/m]; 0 for a landmark on the sensor, where no direction is defined
};

[[nodiscard]] inline Innovation innovation(const Sighting& z, const Pose2& sensor, double x, double y) {
  const double dx = x - sensor.x, dy = y - sensor.y;
  const double r = std::sqrt(dx * dx + dy * dy);
  const double inverse = r < 1e-6 ? 0.0 : 1.0 / r;
  return {z.range - r, wrap(z.bearing + sensor.yaw - std::atan2(dy, dx)), inverse * dx, inverse * dy, inverse};
}

/// Covariance S of an innovation (2x2), with the squared Mahalanobis length of the innovation.
struct InnovationCovariance {
  double rr, rb, bb;
  double determinant;
  double distance2;  ///< +inf where S is not positive definite

  InnovationCovariance(double s_rr, double s_rb, double s_bb, const Innovation& v)
      : rr(s_rr), rb(s_rb), bb(s_bb), determinant(s_rr * s_bb - s_rb * s_rb) {
    distance2 =
        determinant > 0.0 && rr > 0.0
            ? (v.range * (bb * v.range - rb * v.bearing) + v.bearing * (rr * v.bearing - rb * v.range)) / determinant
            : std::numeric_limits<double>::infinity();
  }
  /// log N(v; 0, S)
  [[nodiscard]] double log_density() const {
    return distance2 < std::numeric_limits<double>::infinity()
               ? -0.5 * (distance2 + std::log(determinant)) - std::log(kTwoPi)
               : -std::numeric_limits<double>::infinity();
  }
};

/// P H' of a landmark with covariance P, column by column (range, bearing).
struct CrossCovariance {
  double xr, yr, xb, yb;
};
[[nodiscard]] inline CrossCovariance cross_covariance(const PointLandmark& m, const Innovation& v) {
  return {m.xx * v.ux + m.xy * v.uy, m.xy * v.ux + m.yy * v.uy, v.inverse_range * (m.xy * v.ux - m.xx * v.uy),
          v.inverse_range * (m.yy * v.ux - m.xy * v.uy)};
}

/// H P H' + R
[[nodiscard]] inline InnovationCovariance innovation_covariance(const Sighting& z, const Innovation& v,
                                                                const CrossCovariance& c) {
  return {v.ux * c.xr + v.uy * c.yr + z.rr, v.ux * c.xb + v.uy * c.yb + z.rb,
          v.inverse_range * (v.ux * c.yb - v.uy * c.xb) + z.bb, v};
}

/// Kalman update of the landmark from a pose taken as known. An innovation that is impossible teaches nothing.
inline void take_in(PointLandmark& m, const Innovation& v, const CrossCovariance& c, const InnovationCovariance& s) {
  if (!(s.distance2 < std::numeric_limits<double>::infinity())) return;
  const double scale = 1.0 / s.determinant;
  const double i_rr = s.bb * scale, i_rb = -s.rb * scale, i_bb = s.rr * scale;
  const double xr = c.xr * i_rr + c.xb * i_rb, xb = c.xr * i_rb + c.xb * i_bb;  // the gain
  const double yr = c.yr * i_rr + c.yb * i_rb, yb = c.yr * i_rb + c.yb * i_bb;
  m.x += xr * v.range + xb * v.bearing;
  m.y += yr * v.range + yb * v.bearing;
  m.xx -= xr * c.xr + xb * c.xb;
  m.xy -= xr * c.yr + xb * c.yb;
  m.yy -= yr * c.yr + yb * c.yb;
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
