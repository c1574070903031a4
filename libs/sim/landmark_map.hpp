#pragma once
/// Places of landmarks and way-points.
#include <filesystem>
#include <string>
#include <vector>

#include "core/source.hpp"
#include "sim/landmark_parameters.hpp"

namespace noctule::sim {

/// The places of one block of a map of Tim Bailey's simulator, in metres: a line `lm COLUMNS ROWS` or `wp COLUMNS ROWS`
/// with 2 columns, then so many lines `x y`; `#` begins a comment.
/// \param block `lm` (landmarks) or `wp` (way-points)
/// \throws InputError `file:line: ...`: unreadable, no such block, too few rows, not two finite numbers in a row
[[nodiscard]] std::vector<Vector2> read_places(const std::filesystem::path& file, const std::string& block);

/// Lists, files and scattered places together, to scale.
struct LandmarkMapPlaces {
  Pose2 start;
  std::vector<Vector2> waypoints;  ///< of one loop
  std::vector<KnownLandmark> landmarks;
};
/// \throws InputError also without a way-point or a landmark, or with both a list and a file of way-points
[[nodiscard]] LandmarkMapPlaces places_of(const LandmarkMapParameters&);

}  // namespace noctule::sim
