#pragma once
/// Which fixes of a satellite receiver can be believed.
#include <span>
#include <vector>

#include "core/parameters.hpp"
#include "core/source.hpp"

namespace noctule::datasets {

struct FixFilterParameters {
  double margin = 1.0;   ///< [m]
  double per_way = 0.1;  ///< [1] metres per metre driven
  double pause = 2.0;    ///< [s] a run of fixes ends where none follows for so long ...
  int least_run = 10;    ///< ... and shorter ones are left out

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = FixFilterParameters;
    v.field("margin_m", &P::margin, unit::metre,
            "distances of two believed fixes agree with dead reckoning within this", positive());
    v.field("per_way", &P::per_way, unit::one, "plus this fraction of the way driven between them", at_least(0.0));
    v.field("pause_s", &P::pause, unit::second, "a run of fixes ends where none follows for so long", positive());
    v.field("least_run", &P::least_run, unit::one, "runs of fewer fixes are left out", at_least(1));
  }
};

/// A fix, and where dead reckoning was at its time, in any frame.
struct FixAndOdometry {
  KnownPosition fix;
  Vector2 dead_reckoned = Vector2::Zero();  ///< [m]
  double way = 0.0;                         ///< [m] driven up to there, never decreasing
};

/// Indices of the believed fixes: the longest sequence in which the distance of each fix from the one before agrees
/// with the dead-reckoned distance within margin + per_way * way driven between the two, without its short runs. Jumps
/// are left out however long the receiver stays away; the frame of dead reckoning does not matter, nor does its drift
/// beyond one gap. O(n^2). \param fixes in order of time
[[nodiscard]] std::vector<std::size_t> believed_fixes(std::span<const FixAndOdometry> fixes,
                                                      const FixFilterParameters& parameters);

}  // namespace noctule::datasets
