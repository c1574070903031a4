#pragma once
/// Everything that a run leaves behind, as values: what the results folder and its report are made of.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/contour.hpp"
#include "core/estimate.hpp"
#include "core/image.hpp"
#include "core/source.hpp"
#include "eval/contour_error.hpp"
#include "eval/metrics.hpp"
#include "eval/trajectory.hpp"

namespace noctule::report {

/// A contour map and, where the room is known, its errors.
struct ContourResult {
  ContourMap map;
  std::optional<eval::ContourErrors> errors;
};

/// Occupancy probabilities of square cells, row by row: cell (column, row) at `occupancy[row * columns + column]`
/// covers x from origin.x + column * resolution, y from origin.y + row * resolution (row 0 is the lowest y).
struct OccupancyImage {
  int columns = 0;
  int rows = 0;
  double resolution = 0.0;           ///< [m] side of a cell
  Vector2 origin = Vector2::Zero();  ///< [m] lower left corner of cell (0, 0), map frame
  std::vector<float> occupancy;      ///< in [0, 1]; anything else (NaN, -1) is unknown
};

/// A landmark that a camera saw.
struct SeenLandmark {
  std::int64_t id = -1;
  double range = 0.0;            ///< [m] from the camera
  double bearing = 0.0;          ///< [rad] left positive
  std::vector<Vector2> outline;  ///< in the image, closed [pixels]
};

/// An image and what was found in it.
struct CameraExample {
  double time = 0.0;  ///< [s] of its stamp
  Image image;
  std::vector<SeenLandmark> landmarks;
};

/// What a module said of itself at the end of the run: message counts over all channels that it listens to.
struct ModuleReport {
  std::string name;
  std::string state;
  std::int64_t received = 0;    ///< handled
  std::int64_t missed = 0;      ///< numbers that never came, or came too late
  std::int64_t duplicates = 0;  ///< came twice, handled once
  std::int64_t late = 0;        ///< came after a younger one, not handled
  std::int64_t dropped = 0;     ///< in order, but of no use
  std::int64_t errors = 0;      ///< refused, not decodable or failed in the handler
  std::string last_error;
  std::string warning;
};

/// Poses are of base_link in the map frame. Whatever a run does not have stays empty: the report adapts.
struct RunData {
  // The run.
  std::string title;
  std::string version;  ///< of the program
  std::uint64_t seed = 0;
  std::string config_yaml;  ///< effective configuration, as text
  double duration = 0.0;    ///< [s] of the data, not of the computation
  KnownWorld world;

  // Over time.
  std::vector<SlamEstimate> estimates;  ///< the filter's output, one per observation that it took
  std::vector<eval::TimedPose> truth;
  std::vector<eval::TimedPose> dead_reckoning;  ///< odometry alone
  PathEstimate path;                            ///< the best particle's, at the end

  // Maps.
  std::optional<ContourResult> contours;                 ///< from the filter's path
  std::optional<ContourResult> contours_known_pose;      ///< from the true path: what no filter can beat
  std::optional<ContourResult> contours_dead_reckoning;  ///< from odometry alone
  std::vector<Vector2> direct_points;  ///< readings put on the beam axis along dead reckoning, unfiltered (figure 9a)
  LandmarkMap landmarks;
  bool landmark_ids_known = true;  ///< the landmarks' ids are those of `world`; else errors pair them by distance
  std::optional<OccupancyImage> occupancy;
  std::optional<CameraExample> camera;

  // Figures.
  std::vector<eval::Metric> metrics;  ///< computed from the data alone: equal for equal seeds
  std::vector<eval::Metric> timing;   ///< wall-clock figures; `realtime_factor` is shown first
  std::vector<ModuleReport> modules;
  std::vector<std::string> warnings;  ///< something went wrong or is doubtful; one sentence each
  std::vector<std::string> notes;     ///< worth knowing
};

}  // namespace noctule::report
