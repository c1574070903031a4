#pragma once
/// Many objects seen as points among false alarms: what its filters share.
#include <cstdint>
#include <span>
#include <vector>

#include "core/parameters.hpp"
#include "models/constant_velocity.hpp"

namespace noctule::filters {

/// One object as a filter sees it. A label stays with its object.
struct ObjectEstimate {
  std::int64_t label = 0;
  models::Vector4 state = models::Vector4::Zero();  ///< (x, vx, y, vy)
  models::Matrix4 covariance = models::Matrix4::Zero();
  [[nodiscard]] Vector2 position() const { return {state[0], state[2]}; }
};

/// How objects move and are seen.
struct ObjectModel {
  double period = 1.0;            ///< [s] between scans
  double acceleration_sd = 0.5;   ///< [m/s^2]
  double position_sd = 10.0;      ///< [m] of a measured coordinate
  double detection = 0.98;        ///< probability that an object is seen
  double clutter_density = 5e-6;  ///< false alarms per scan and square metre
  double initial_speed_sd = 5.0;  ///< [m/s] of each component of a new object's velocity

  [[nodiscard]] models::ConstantVelocity motion() const { return {period, acceleration_sd}; }
  /// The state of an object that was first seen at `z`.
  [[nodiscard]] ObjectEstimate first_seen(std::int64_t label, const Vector2& z) const {
    ObjectEstimate o{label, models::Vector4(z.x(), 0.0, z.y(), 0.0), models::Matrix4::Zero()};
    const double r = position_sd * position_sd, v = initial_speed_sd * initial_speed_sd;
    o.covariance.diagonal() << r, v, r, v;
    return o;
  }

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = ObjectModel;
    v.field("period_s", &P::period, unit::second, "time between scans", positive());
    v.field("acceleration_sd_m_per_s2", &P::acceleration_sd, Unit{"m/s^2", 1.0}, "sd of each component", at_least(0.0));
    v.field("position_sd_m", &P::position_sd, unit::metre, "sd of a measured coordinate", positive());
    v.field("detection", &P::detection, unit::one, "probability that an object is seen",
            Range{.min = 0.0, .max = 1.0, .min_allowed = false, .max_allowed = false});
    v.field("clutter_density_per_m2", &P::clutter_density, Unit{"1/m^2", 1.0}, "false alarms per scan and area",
            positive());
    v.field("initial_speed_sd_m_per_s", &P::initial_speed_sd, unit::metre_per_second,
            "sd of each component of a new object's velocity", positive());
  }
};

/// The common door: one call per scan, in order of time.
class MultiObjectFilter {
 public:
  virtual ~MultiObjectFilter() = default;
  /// Moves on by one period and takes a scan, which may be empty. \throws InputError for a measurement that is not
  /// finite; the filter is as before
  virtual void update(std::span<const Vector2> measurements) = 0;
  /// Objects that the filter holds for real after the latest scan, by ascending label.
  [[nodiscard]] virtual std::vector<ObjectEstimate> objects() const = 0;
};

}  // namespace noctule::filters
