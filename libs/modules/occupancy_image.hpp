#pragma once
#include <span>

#include "mapping/contour_mapper.hpp"
#include "mapping/occupancy_grid.hpp"
#include "report/run_data.hpp"

namespace noctule::modules {

/// The grid that all scans together give, as the report takes it; cells that no echo has touched are unknown.
/// \throws InputError when the grid would be larger than its parameters allow
[[nodiscard]] report::OccupancyImage occupancy_image(std::span<const mapping::PosedScan> scans,
                                                     const mapping::OccupancyParameters& parameters);

}  // namespace noctule::modules
