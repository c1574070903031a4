#pragma once
/// The tables of the report, as HTML. Each is empty where the run has nothing to put in.
#include <optional>
#include <string>
#include <vector>

#include "report/run_data.hpp"

namespace noctule::report {

/// The value of a metric, where it is there and finite.
[[nodiscard]] std::optional<double> find_metric(const std::vector<eval::Metric>& metrics, const std::string& name);

/// Whether the run's room is the one whose published figures may stand beside ours.
[[nodiscard]] bool has_published_figures(const RunData& data);

/// Walls (rho, theta) in the layout of the paper's table 3, cylinders (x, y, R) in that of table 4: truth, filter,
/// known-pose mapping, dead reckoning and, where they apply, the paper's columns.
[[nodiscard]] std::string wall_table(const RunData& data);
[[nodiscard]] std::string cylinder_table(const RunData& data);
/// The estimated contours with their standard deviations, for a room that nobody has measured.
[[nodiscard]] std::string found_walls_table(const ContourMap& map);
[[nodiscard]] std::string found_cylinders_table(const ContourMap& map);

/// All metrics, one row a name, with the suffixes `_known_pose` and `_dead_reckoning` as columns.
[[nodiscard]] std::string metric_table(const RunData& data);
[[nodiscard]] std::string timing_table(const RunData& data);
[[nodiscard]] std::string module_table(const RunData& data);

}  // namespace noctule::report
