#pragma once
/// A room from the corners of its outline.
#include <filesystem>
#include <span>

#include "core/contour.hpp"

namespace noctule::datasets {

/// Walls "wall 1", "wall 2", ... of a simple polygon seen from inside, in the order of its corners [m]; either sense
/// of rotation, closed or not. Corners on a straight line are left out: one line is one wall. A wall through the
/// origin has the normal that points out of the room.
/// \throws std::invalid_argument for fewer than three corners or an outline without area
[[nodiscard]] Room room_from_outline(std::span<const Vector2> corners);

/// The same from a table x_m,y_m with that header.
/// \throws InputError for a damaged file, or corners that enclose no area
[[nodiscard]] Room read_outline(const std::filesystem::path& path);

}  // namespace noctule::datasets
