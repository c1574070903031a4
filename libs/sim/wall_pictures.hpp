#pragma once
/// What hangs on the walls of a room.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/image.hpp"
#include "core/pose2.hpp"
#include "core/source.hpp"
#include "sim/room_geometry.hpp"
#include "sim/world.hpp"

namespace noctule::sim {

/// A square on a wall, upright.
struct WallPicture {
  std::int64_t landmark = 0;
  std::size_t wall = 0;      ///< number of the wall
  double along = 0.0;        ///< its middle from the wall's `from` [m]; left as seen from the room is further along
  double height = 0.0;       ///< its middle over the floor [m]
  double half = 0.0;         ///< half its side [m]
  std::uint64_t number = 0;  ///< of the sign picture or the marker
  bool fiducial = false;

  /// Grey, 512 pixels a side.
  [[nodiscard]] Image image() const;
  /// Top left, top right, bottom right, bottom left as seen from the room; map frame, z up [m].
  [[nodiscard]] std::array<Vector3, 4> corners(const WallSegment&) const;
};

/// \throws InputError for a wall that is not there, a picture beyond its wall, two on the same place, and a landmark's
///         number given twice
[[nodiscard]] std::vector<WallPicture> hang_pictures(const RoomParameters&, const RoomGeometry&);

/// Middles of what hangs on the walls and of the posts, in the map.
[[nodiscard]] std::vector<KnownLandmark> known_landmarks(const RoomParameters&, const RoomGeometry&);

}  // namespace noctule::sim
