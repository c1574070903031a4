#pragma once
/// Ranges from several positions, and the surfaces they fit in closed form (the three-position method). The closed
/// forms ignore noise; `surface_fit.hpp` starts from them.
#include <optional>
#include <span>

#include "core/features.hpp"

namespace noctule::sensors {

/// Most sightings that one fit takes.
inline constexpr int kMaxSightings = 16;

/// One object heard from one place: the range and direction of a region of constant depth, in the frame of the fit.
/// Spans of sightings are in order of time, oldest first.
struct Sighting {
  Vector2 position = Vector2::Zero();  ///< sensor [m]
  double range = 0.0;                  ///< [m]
  double range_variance = 0.0;         ///< of the ranging alone [m^2]
  double direction = 0.0;              ///< of the echo [rad]
  double direction_variance = 0.0;     ///< of the hearing alone [rad^2]; +inf: the direction is not used
  /// Variance of an error that all directions share, on top: pings on a fixed grid of angles pull the directions of
  /// one surface to the same side at every stop [rad^2].
  double direction_bias_variance = 0.0;
  /// Covariance of the twist (x, y, yaw) about the origin by which odometry may have displaced this stop in the frame
  /// of the fit: a point p of the stop moves by (x, y) + yaw * (-p.y, p.x). Twists accumulate backwards in time, so
  /// that two stops share the twist of the later one: Cov(i, j) = drift of max(i, j).
  Matrix3 drift = Matrix3::Zero();
};

/// How sightings and surfaces look after the base has moved: `motion` is the new base in the old one, and both frames
/// are bases. First order in the covariance of the motion.
class FrameChange {
 public:
  explicit FrameChange(const PoseGaussian& motion);

  void apply(Sighting& sighting) const;
  void apply(Wall& wall, Matrix2& covariance) const;          ///< covariance order (rho, theta)
  void apply(Vector2& point, Matrix2& covariance) const;      ///< covariance order (x, y)
  void apply(Cylinder& cylinder, Matrix3& covariance) const;  ///< covariance order (x, y, radius)
  void apply(ContourFeature& feature) const;

 private:
  Pose2 new_T_old_;
  Matrix3 adjoint_;  ///< takes twists of the old frame to the new one
  Matrix3 drift_;    ///< covariance of the motion's twist in the new frame
};

/// Squared misfit of a surface, each range and direction weighted by its own variance.
[[nodiscard]] double misfit(std::span<const Sighting> sightings, const Wall& wall);
[[nodiscard]] double misfit(std::span<const Sighting> sightings, const Cylinder& cylinder);

/// Common tangent of n >= 2 circles: minimises sum (r_i - rho + n.p_i)^2 subject to |n| = 1 through the two local
/// minima of the secular equation (More and Sorensen 1983; Martinez 1994). Positions on one line leave two mirror
/// images; the one with the smaller misfit is returned, so that the directions decide (without any: the one to the
/// left of the line from the first to the last position).
/// \return nothing when the positions coincide
[[nodiscard]] std::optional<Wall> tangent_wall(std::span<const Sighting> sightings);

/// Point at the given distances from n >= 2 positions. Linear least squares; where the positions lie on (nearly) one
/// line the distance from the line follows from the ranges and the directions choose its side.
/// \return nothing when the positions coincide or no candidate is real
[[nodiscard]] std::optional<Vector2> point_at_ranges(std::span<const Sighting> sightings);

/// Circle tangent to n >= 3 circles of the given radii from outside (problem of Apollonius): linear in centre and
/// radius given |c|^2 - R^2, which then solves a quadratic. Roots with a radius outside (0, max_radius] are dropped,
/// of the others the one with the smallest misfit is returned.
/// \return nothing when no root is left
[[nodiscard]] std::optional<Cylinder> apollonius(std::span<const Sighting> sightings, double max_radius);

/// Largest distance between two positions [m].
[[nodiscard]] double baseline(std::span<const Sighting> sightings);

/// Baseline that separates a wall from a point at `range` by three standard deviations: the second difference of
/// three equally spaced ranges is (L/2)^2 / r for a point, 0 for a wall, and has the sd sqrt(6) sigma.
[[nodiscard]] double separating_baseline(double range, double sigma);

}  // namespace noctule::sensors
