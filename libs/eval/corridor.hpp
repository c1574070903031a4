#pragma once
/// An L-shaped corridor judged by itself: its walls are parallel, at right angles and a known width apart.
#include <optional>
#include <span>

#include "core/angles.hpp"
#include "core/contour.hpp"

namespace noctule::eval {

struct CorridorParameters {
  double alignment = radians(15.0);  ///< a leg's walls are this parallel to the leg [rad]
  double reach = 3.0;                ///< and at most this far from its middle [m]
  double margin = 1.0;               ///< of a leg that the middles of its walls may lie beyond its ends [m]

  [[nodiscard]] bool valid() const { return alignment > 0.0 && reach > 0.0 && margin >= 0.0; }
};

/// What the map says of the corridor; nothing where the walls for it are missing.
struct CorridorFigures {
  int left = -1;    ///< index in the map's walls: best supported to the left of the first leg
  int right = -1;   ///< and to its right
  int second = -1;  ///< on the side of the second leg whose best supported wall has the better known direction
  std::optional<double> width;        ///< [m] between left and right, at the middle of the first leg
  std::optional<double> parallelism;  ///< [rad] between left and right, signed
  std::optional<double> corner;       ///< [rad] between the first leg's walls (their mean) and the second's
};

/// Splits the way into two straight legs, where the squared distances of the positions from two lines are least, and
/// looks for the walls along each that most echoes speak for.
/// \param positions of the robot [m], map frame, in order; standing still counts once
/// \throws std::invalid_argument for parameters out of range
[[nodiscard]] CorridorFigures corridor_figures(const ContourMap& map, std::span<const Vector2> positions,
                                               const CorridorParameters& parameters = {});

}  // namespace noctule::eval
