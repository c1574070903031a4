#include "modules/occupancy_image.hpp"

namespace noctule::modules {

report::OccupancyImage occupancy_image(std::span<const mapping::PosedScan> scans,
                                       const mapping::OccupancyParameters& parameters) {
  constexpr float kUnknown = -1.0F;
  mapping::OccupancyGrid grid(parameters);
  for (const mapping::PosedScan& posed : scans) grid.add(posed.scan, posed.base_in_map);

  report::OccupancyImage image{grid.width(), grid.height(), grid.resolution(), grid.origin(), {}};
  image.occupancy.reserve(static_cast<std::size_t>(image.columns) * static_cast<std::size_t>(image.rows));
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const bool known = grid.log_odds(column, row) != 0.0;
      image.occupancy.push_back(known ? static_cast<float>(grid.probability(column, row)) : kUnknown);
    }
  }
  return image;
}

}  // namespace noctule::modules
