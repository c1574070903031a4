#pragma once
/// Contour maps and positions as CSV, metres and radians in the map frame; headers may be there or not.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/contour.hpp"
#include "core/source.hpp"

namespace noctule::eval {

/// `rho,theta,begin,end` a line, ends as in WallEstimate.
[[nodiscard]] std::string walls_csv(std::span<const RoomWall> walls);
/// `x,y,radius` a line.
[[nodiscard]] std::string cylinders_csv(std::span<const RoomCylinder> cylinders);
/// \param place of the text, for messages: a file name; names of the contours are "wall 1", "wall 2" ...
/// \throws InputError `place:line: ...`: not so many finite numbers, a negative radius (both functions)
[[nodiscard]] std::vector<RoomWall> parse_walls(std::string_view text, const std::string& place);
[[nodiscard]] std::vector<RoomCylinder> parse_cylinders(std::string_view text, const std::string& place);

/// Only what the files of a room hold: names, and neither covariances nor counts.
[[nodiscard]] Room as_room(const ContourMap& map);
[[nodiscard]] ContourMap as_map(const Room& room);

/// `t,x,y` a line, t in seconds.
[[nodiscard]] std::string fixes_csv(std::span<const KnownPosition> fixes);
/// \throws InputError as above, and for times that do not increase
[[nodiscard]] std::vector<KnownPosition> parse_fixes(std::string_view text, const std::string& place);

}  // namespace noctule::eval
