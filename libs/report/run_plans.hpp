#pragma once
/// The plans of a run: which layers each drawing has.
#include <string>

#include "report/run_data.hpp"

namespace noctule::report {

/// Estimated contours and landmarks over the known ones, with uncertainty and path: as a file of its own.
[[nodiscard]] std::string map_svg(const RunData& data);

/// The same for the page.
[[nodiscard]] std::string map_plan(const RunData& data);
/// Readings as they came, along dead reckoning.
[[nodiscard]] std::string readings_plan(const RunData& data);
/// Contours that the mapper made of another path: the limit, or no filter at all.
[[nodiscard]] std::string contour_plan(const RunData& data, const ContourResult& contours, const std::string& title);
/// Path of the filter, of dead reckoning and the truth.
[[nodiscard]] std::string path_plan(const RunData& data);
/// The occupancy grid; empty where there is none or it is too large to draw.
[[nodiscard]] std::string occupancy_plan(const RunData& data);

}  // namespace noctule::report
