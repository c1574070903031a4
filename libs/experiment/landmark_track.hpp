#pragma once
/// A run among landmarks, and how good a track of it is.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/estimate.hpp"
#include "core/source.hpp"
#include "experiment/row.hpp"
#include "sim/landmark_world.hpp"

namespace noctule::experiment {

/// One scan and the motion before it.
struct LandmarkScan {
  std::vector<Odometry> odometry;
  LandmarkDetections sightings;  ///< what filters are fed
  LandmarkDetections informed;   ///< the same as sim::LandmarkWorld::informed() has them
  Pose2 truth;
};

/// What all filters of one seed are fed.
struct LandmarkStream {
  Pose2 start;
  std::vector<LandmarkScan> scans;
  std::vector<KnownLandmark> seen;   ///< landmarks that were sighted at all
  double path_length = 0.0;          ///< [m]
  std::vector<std::size_t> samples;  ///< scans at which curves have a point, the last one included
};

/// \param period time between two points of curves [s]
[[nodiscard]] LandmarkStream record(const std::shared_ptr<const sim::LandmarkScene>&, std::uint64_t seed,
                                    double period);

/// What was made of a stream.
struct LandmarkTrack {
  std::vector<SlamEstimate> estimates;  ///< one per scan; `particles` is 0 where there are none
  LandmarkMap map;                      ///< at the end
  std::vector<double> landmark_errors;  ///< RMS [m] at the samples; empty where no map was known before the end
  double computing = 0.0;               ///< CPU time [s]
};

struct LandmarkJudgement {
  bool known_ids = true;      ///< landmarks are paired by id; else by their places
  bool as_sets = false;       ///< OSPA and GOSPA too
  double match_within = 5.0;  ///< pairs farther apart are none where ids are unknown; cutoff of OSPA and GOSPA [m]
  double segment = 10.0;      ///< [m] true way over which relative pose errors are taken
};

/// RMS error [m] of the landmarks in the map.
[[nodiscard]] double landmark_rmse(const LandmarkMap&, const LandmarkStream&, const LandmarkJudgement&);

/// Names of all figures and curves. \param as_sets as in LandmarkJudgement
[[nodiscard]] std::vector<std::string> landmark_metric_names(bool as_sets);

/// Figures, curves, times and divergence of a track. Nothing is aligned: SLAM starts at the true pose.
[[nodiscard]] FilterRun judge(const LandmarkTrack&, const LandmarkStream&, const LandmarkJudgement&);

}  // namespace noctule::experiment
