#pragma once
/// The results folder of a run.
#include <filesystem>
#include <vector>

#include "report/run_data.hpp"

namespace noctule::report {

/// The metrics that every run has, from what `data` holds: the contour metrics of the three maps (suffixes none,
/// `_known_pose`, `_dead_reckoning`), `position_rmse`, `heading_rmse`, `position_max`, `heading_max`, `ate_rmse`,
/// `rpe_translation_rmse`, `rpe_rotation_rmse` (1 m segments), each also `_dead_reckoning`; `fix_rmse` (position fixes,
/// after SE(2) alignment), also `_dead_reckoning`; `landmark_rmse`,
/// `landmarks_found`, `landmarks_missed`, `landmarks_invented`; `nees_mean`, `nees_median`, `nees_inside`, `nis_mean`,
/// `path_length`. What needs a truth that is not there is left out. Meant for `RunData::metrics`; append what else was
/// measured.
[[nodiscard]] std::vector<eval::Metric> run_metrics(const RunData& data);

/// Creates the folder where it is missing and makes sure that files can be written there: call it before a long run.
/// \throws InputError naming the folder and the reason
void prepare_results(const std::filesystem::path& dir);

/// Writes metrics.json, metrics.csv, timing.json, config.yaml, trajectory.tum, path.tum, ground_truth.tum,
/// dead_reckoning.tum, fixes.csv, landmarks.csv, walls.csv, cylinders.csv and what is known of these (known_*.csv),
/// map.svg, map.pgm with map.yaml (where there is an occupancy grid) and report.html. Each file appears whole under its
/// name or not at all. Equal data give equal bytes. \throws InputError naming the file and the reason
void write_results(const RunData& data, const std::filesystem::path& dir);

}  // namespace noctule::report
