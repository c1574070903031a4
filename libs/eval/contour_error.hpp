#pragma once
/// How well an estimated contour map agrees with a known room (the measures of tables 3 and 4 of Yuan et al.,
/// Chinese Journal of Scientific Instrument 2021, 10.19650/j.cnki.cjsi.J2108489).
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/angles.hpp"
#include "core/contour.hpp"
#include "eval/metrics.hpp"

namespace noctule::eval {

struct ContourErrorParameters {
  double rho_scale = 0.05;            ///< [m] |d rho| of this size costs 1 in the association of walls
  double theta_scale = radians(5.0);  ///< [rad] |d theta| of this size costs 1
  double wall_gate = 3.0;             ///< pairs that cost this much are no pairs; +inf pairs as many as possible
  double cylinder_gate = 0.30;        ///< [m] cylinders farther apart than this are no pair
  /// Wall that the means "over the other walls" leave out: the one that the start pose measures and so anchors the
  /// frame. Empty: the first wall of the room.
  std::string anchor_wall = {};
};

/// A known wall and what was found of it.
struct WallError {
  std::string name;
  Wall truth;
  bool anchor = false;
  int estimate = -1;                 ///< index in the map's walls, -1: missed
  double rho = 0.0;                  ///< [m] estimate - truth, on the branch of (rho, theta) nearer to the truth
  double theta = 0.0;                ///< [rad] estimate - truth, in [-pi, pi)
  double theta_rotation_free = 0.0;  ///< [rad] the same with the rotation common to all walls removed
  [[nodiscard]] bool found() const { return estimate >= 0; }
};

/// A known cylinder and what was found of it.
struct CylinderError {
  std::string name;
  Cylinder truth;
  int estimate = -1;                 ///< index in the map's cylinders, -1: missed
  Vector2 centre = Vector2::Zero();  ///< [m] estimate - truth
  double radius = 0.0;               ///< [m] estimate - truth
  [[nodiscard]] bool found() const { return estimate >= 0; }
  /// [m] mean of |dx|, |dy| and |dR| (table 4).
  [[nodiscard]] double mean_absolute() const;
};

/// Mean absolute errors over a set of walls; NaN where none of them was found.
struct WallMeans {
  int found = 0;
  double rho = 0.0;                  ///< [m]
  double theta = 0.0;                ///< [rad]
  double theta_rotation_free = 0.0;  ///< [rad]
};

struct ContourErrors {
  std::vector<WallError> walls;          ///< in the order of the room
  std::vector<CylinderError> cylinders;  ///< in the order of the room
  std::vector<int> invented_walls;       ///< indices in the map of what is not in the room
  std::vector<int> invented_cylinders;
  double common_rotation = 0.0;  ///< [rad] circular mean of the walls' theta errors, weighted by their true lengths
  WallMeans other_walls;         ///< walls other than the anchor (walls 2 to 7 of table 3)
  WallMeans all_walls;
  double cylinder_mae = 0.0;         ///< [m] mean of |dx|, |dy|, |dR| over the cylinders found; NaN: none
  double cylinder_mae_radius = 0.0;  ///< [m] mean of |dR|; NaN: none

  [[nodiscard]] int walls_found() const { return all_walls.found; }
  [[nodiscard]] int walls_missed() const { return static_cast<int>(walls.size()) - walls_found(); }
  [[nodiscard]] int cylinders_found() const;
  [[nodiscard]] int cylinders_missed() const { return static_cast<int>(cylinders.size()) - cylinders_found(); }
  /// Everything in the room was found and nothing invented.
  [[nodiscard]] bool complete() const;
};

/// Associates walls by the Hungarian method with cost |d rho| / rho_scale + |d theta| / theta_scale, theta modulo a
/// turn and (rho, theta) = (-rho, theta + pi); cylinders by the distance of their centres. Contours with numbers that
/// are not finite are never found.
/// \throws std::invalid_argument when a parameter is not positive or `anchor_wall` is not in the room
[[nodiscard]] ContourErrors contour_errors(const ContourMap&, const Room&, const ContourErrorParameters& = {});

/// The errors as named metrics: `walls_found`, `walls_missed`, `walls_invented`, the same for cylinders,
/// `wall_mae_rho`, `wall_mae_theta`, `wall_mae_theta_rotation_free` (walls other than the anchor),
/// `wall_mae_rho_all`, `wall_mae_theta_all`, `common_rotation`, `cylinder_mae`, `cylinder_mae_radius`, and
/// `cylinder_mae_1`, `cylinder_mae_2` ... in the order of the room; `suffix` is appended to each name.
[[nodiscard]] std::vector<Metric> contour_metrics(const ContourErrors&, std::string_view suffix = {});

}  // namespace noctule::eval
