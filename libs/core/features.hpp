#pragma once
/// Contour features: what a few sonar readings say about the surface that made them.
#include <cstdint>
#include <vector>

#include "core/observations.hpp"

namespace noctule {

enum class ContourType : std::int8_t {
  wall = 0,      ///< a plane: range = rho - n(theta).p
  arc = 1,       ///< a convex cylinder: range = |p - c| - R
  point = 2,     ///< a corner or an edge: range = |p - c| (a cylinder with R = 0)
  ambiguous = 3  ///< decide later: wall and circle both fit (has_wall and has_circle), or a circle of open radius does
};

/// A line rho = x cos(theta) + y sin(theta) whose normal (cos theta, sin theta) points from the free side towards the
/// wall, so that the distance from a free point p is rho - n.p. On output rho >= 0 in the map frame; inside filters
/// any sign.
struct Wall {
  double rho = 0.0;    ///< [m]
  double theta = 0.0;  ///< [rad]

  [[nodiscard]] Vector2 normal() const { return {std::cos(theta), std::sin(theta)}; }
  [[nodiscard]] Vector2 tangent() const { return {-std::sin(theta), std::cos(theta)}; }
  [[nodiscard]] double distance(const Vector2& p) const { return rho - normal().dot(p); }
};

/// The same line with rho >= 0, theta in [-pi, pi).
[[nodiscard]] inline Wall normalised(Wall w) {
  if (w.rho < 0.0) w = {-w.rho, w.theta + kPi};
  return {w.rho, wrap(w.theta)};
}

/// A wall of frame B expressed in frame A, a_T_b being the pose of B in A.
[[nodiscard]] inline Wall transformed(const Pose2& a_T_b, const Wall& w) {
  const double theta = wrap(w.theta + a_T_b.yaw);
  return {w.rho + std::cos(theta) * a_T_b.x + std::sin(theta) * a_T_b.y, theta};
}

struct Cylinder {
  Vector2 centre = Vector2::Zero();  ///< [m]
  double radius = 0.0;               ///< [m], 0 for a point
  [[nodiscard]] double distance(const Vector2& p) const { return (centre - p).norm() - radius; }
};

/// Result of the extractor for one object seen from one or more stops, in base_link at the time of `Stamp`.
/// Made from odometry-relative poses only, never from SLAM poses. Where a hypothesis was not fitted its flag is false
/// and its numbers are 0.
struct ContourFeature {
  ContourType type = ContourType::ambiguous;
  std::int64_t track = -1;  ///< the extractor's own number of the object; the same object keeps it over scans

  bool has_wall = false;
  Wall wall;
  Matrix2 wall_covariance = Matrix2::Zero();  ///< order (rho, theta)
  double wall_log_likelihood = 0.0;

  bool has_circle = false;
  Cylinder circle;                              ///< radius 0 when the point model was fitted
  Matrix3 circle_covariance = Matrix3::Zero();  ///< order (x, y, radius)
  double circle_log_likelihood = 0.0;

  Vector2 surface = Vector2::Zero();  ///< nearest point of the surface to the base, from the latest stop [m]
  int stops = 0;                      ///< different sensor positions that support it
  double baseline = 0.0;              ///< largest distance between two of them [m]
  std::vector<ReadingId> readings;    ///< every reading used, the current scan's included
};

struct ContourFeatures {
  Stamp stamp;  ///< of the scan that completed them
  std::vector<ContourFeature> features;
};

}  // namespace noctule
