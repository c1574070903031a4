#pragma once
/// Occupancy maps in the files of ROS's map_server.
#include <string>

#include "report/run_data.hpp"

namespace noctule::report {

inline constexpr double kOccupiedAbove = 0.65;  ///< thresholds of map_server
inline constexpr double kFreeBelow = 0.196;

/// Binary PGM, top row first, in map_server's "trinary" shades: 0 occupied, 254 free, 205 unknown or undecided.
/// \throws std::invalid_argument when the number of cells is not columns x rows
[[nodiscard]] std::string to_pgm(const OccupancyImage& image);

/// The YAML beside it; `image_name` is the name of the PGM.
[[nodiscard]] std::string to_map_yaml(const OccupancyImage& image, const std::string& image_name);

}  // namespace noctule::report
