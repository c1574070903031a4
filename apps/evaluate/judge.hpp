#pragma once
/// Estimates and truths in files, and what the figures say.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/metrics.hpp"
#include "eval/trajectory3.hpp"

namespace noctule::apps {

enum class Association { interpolate, nearest };
enum class Pairing { id, distance };
enum class SegmentChoice { every_pose, end_to_end, nearest };

/// What is compared with what; an empty path: not compared.
struct EvaluationFiles {
  std::filesystem::path estimate, truth;               ///< trajectories (TUM)
  std::filesystem::path fixes;                         ///< positions as truth, where no trajectory is
  std::filesystem::path landmarks, known_landmarks;    ///< id,x,y
  std::filesystem::path walls, cylinders;              ///< a contour map
  std::filesystem::path known_walls, known_cylinders;  ///< a known room, in files of the same kind ...
  std::filesystem::path world;                         ///< ... or as a world file (config/worlds)
};

struct EvaluationOptions {
  eval::Alignment3 alignment = eval::Alignment3::none;
  Association association = Association::interpolate;
  double max_difference = 0.01;   ///< [s] of two times that are paired (nearest), ...
  double max_gap = 2.0;           ///< ... or between poses that are interpolated
  std::vector<double> lengths;    ///< [m] of the segments of relative errors
  std::vector<double> durations;  ///< [s]
  std::vector<double> steps;      ///< [1] poses
  SegmentChoice segments = SegmentChoice::every_pose;
  std::optional<Pairing> pairing;    ///< of landmarks; nothing: by id where the two files share one
  bool align_landmarks = false;      ///< SE(2), among themselves
  double gate = 1.0;                 ///< [m] of landmarks paired by distance
  double order = 1.0, cutoff = 1.0;  ///< p [1] and c [m] of OSPA and GOSPA
};

/// The files of a results folder that are there, for what `files` leaves open.
/// \throws InputError where the folder holds nothing to compare
void complete_from_results(const std::filesystem::path& folder, EvaluationFiles& files);

/// \throws InputError for what cannot be read or compared, naming it
[[nodiscard]] std::vector<eval::Metric> evaluate(const EvaluationFiles& files, const EvaluationOptions& options);

}  // namespace noctule::apps
