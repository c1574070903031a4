#pragma once
/// Tree trunks and other upright round things in the plane of a laser scanner.
#include <span>
#include <vector>

#include "core/observations.hpp"
#include "core/parameters.hpp"

namespace noctule::models {

struct TrunkParameters {
  double max_range = 30.0;           ///< [m] of the trunk's front
  double max_diameter = 1.0;         ///< [m]
  int min_beams = 2;                 ///< that hit it
  double split = 0.5;                ///< [m] neighbouring ranges that differ by more hit different things
  double clearance = 2.0;            ///< [m] what is seen on both sides lies farther back by this
  double range_sd = 0.6;             ///< [m] of the distance of the centre, beside what the beam's width does to it
  double bearing_sd = radians(1.2);  ///< [rad] likewise

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = TrunkParameters;
    v.field("max_range_m", &P::max_range, unit::metre, "farther trunks are left out", positive());
    v.field("max_diameter_m", &P::max_diameter, unit::metre, "wider things are no trunks", positive());
    v.field("min_beams", &P::min_beams, unit::one, "beams that hit a trunk at least", at_least(1));
    v.field("split_m", &P::split, unit::metre, "neighbouring ranges that differ by more hit different things",
            positive());
    v.field("clearance_m", &P::clearance, unit::metre, "what is seen on both sides lies farther back by this",
            at_least(0.0));
    v.field("range_sd_m", &P::range_sd, unit::metre,
            "sd of the distance of a trunk's centre, beside what the spacing of the beams does to it", positive());
    v.field("bearing_sd_deg", &P::bearing_sd, unit::degree, "sd of its bearing, likewise", positive());
  }
};

/// A fan of ranges from one place.
struct RangeFan {
  double first_bearing = 0.0;      ///< [rad] from the sensor's x axis, left positive
  double step = 0.0;               ///< [rad] from beam to beam, > 0
  double no_return_above = 0.0;    ///< [m] larger ranges mean that nothing was hit
  std::span<const double> ranges;  ///< [m]
};

/// Sightings of the centres of trunks, without identity. A trunk is a run of neighbouring ranges that stands free in
/// front of what is behind it on both sides, as wide as a circle of at most the largest diameter, and no deeper than
/// that circle. Seen under an angle 2 beta at mean range m, its centre is m / (1 - pi / 4 sin(beta)) away: the mean
/// depth of a circle's front, over its width, is pi / 4 of the radius. The covariance holds what the spacing of the
/// beams leaves unknown about the two edges, each uniform in one step.
[[nodiscard]] std::vector<LandmarkDetection> find_trunks(const RangeFan& fan, const TrunkParameters& parameters);

}  // namespace noctule::models
