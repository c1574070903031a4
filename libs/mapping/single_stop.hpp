#pragma once
/// What one place alone can tell of the walls.
#include <span>

#include "core/contour.hpp"
#include "core/parameters.hpp"
#include "mapping/sonar_arc.hpp"

namespace noctule::mapping {

/// Every echo of one place fits a wall, a corner and a cylinder equally well. In this mode each region of constant
/// depth (Leonard and Durrant-Whyte 1992) is taken for a wall, but one where two nearer walls would meet for their
/// corner.
struct SingleStopParameters {
  bool enabled = false;
  int min_readings = 5;
  double min_extent = radians(8.0);  ///< between the outermost axes of a region [rad]
  double tolerance = 0.06;           ///< ranges of a region differ from their median by at most this [m]
  double max_contradiction = 0.5;    ///< directions heard from behind a region, per direction heard from it

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SingleStopParameters;
    v.field("enabled", &P::enabled, unit::one, "take every region of constant depth of a stop for a wall");
    v.field("min_readings", &P::min_readings, unit::one, "echoes of a region", at_least(2));
    v.field("min_extent_deg", &P::min_extent, unit::degree, "angle between the outermost echoes of a region",
            at_least(0.0));
    v.field("tolerance_cm", &P::tolerance, unit::centimetre, "largest difference from the region's median range",
            positive());
    v.field("max_contradiction", &P::max_contradiction, unit::one,
            "directions heard from behind a region, per direction heard from it", positive());
  }
};

/// Walls, and corners as points, that each stop's echoes suggest, stop after stop, those with most echoes first. The
/// region that most echoes agree on is taken, its echoes leave, and so on. `begin` and `end` bound where the foot of
/// the perpendicular lies (one standard deviation of theta): more of the wall was not heard. Without a stamp.
[[nodiscard]] ContourMap single_stop_map(std::span<const SonarArc> arcs, const SingleStopParameters& parameters);

}  // namespace noctule::mapping
