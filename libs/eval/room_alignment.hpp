#pragma once
/// Errors of a map whose place in the known room is itself estimated: the alignment never sees the wall it is used for.
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/angles.hpp"
#include "core/contour.hpp"
#include "eval/contour_error.hpp"

namespace noctule::eval {

struct RoomAlignmentParameters {
  double rho_gate = 0.6;              ///< [m] walls whose distances from the ranger differ by more are no pair
  double theta_gate = radians(25.0);  ///< [rad]
};

/// A known wall that could be heard, and what was found of it.
struct AlignedWall {
  std::string name;
  Wall truth;           ///< room frame
  int estimate = -1;    ///< index in the map's walls, -1: missed
  bool scored = false;  ///< the others fixed an alignment
  double rho = 0.0;     ///< [m] distance from the ranger, aligned by the other walls, minus truth; 0 if not scored
  double theta = 0.0;   ///< [rad] the same of the direction
};

struct RoomAlignment {
  std::vector<AlignedWall> walls;   ///< those that could be heard, in the order of the room
  std::vector<int> invented_walls;  ///< indices in the map of what is none of them
  Pose2 room_T_map;                 ///< by all walls found; the identity where they fix none
  int found = 0;
  int scored = 0;
  double recall = 0.0;        ///< found / could be heard; NaN: none could
  double median_rho = 0.0;    ///< [m] of |rho| over scored walls; NaN: none
  double median_theta = 0.0;  ///< [rad]
};

/// Indices of the walls whose foot of the perpendicular from one of the places [m] lies on the wall, with no other wall
/// in between: a ranger at that place can hear them.
[[nodiscard]] std::vector<int> audible_walls(const Room& room, std::span<const Vector2> places);

/// The rigid motion that brings estimated walls to known ones, least squares: the mean difference of theta, then the
/// translation that fits the differences of rho, which should be distances from where the walls were heard. Pairs are
/// (estimate, truth). Nothing where the walls' normals do not span the plane.
[[nodiscard]] std::optional<Pose2> align_walls(std::span<const std::pair<Wall, Wall>> pairs);

/// Pairs the audible walls with the map's (Hungarian method, at first as the map lies, then once more after an
/// alignment by the pairs), then scores each pair by the alignment that all other pairs give. Distances are those from
/// the ranger, the mean of its places, which the alignment moves along with the map.
/// \param places where the ranger was [m], in the frame of the map, roughly that of the room
/// \throws std::invalid_argument for no place, gates that are not positive
[[nodiscard]] RoomAlignment align_to_room(const ContourMap& map, const Room& room, std::span<const Vector2> places,
                                          const RoomAlignmentParameters& parameters = {});

/// The same as errors of contours, for reports: the walls that could be heard, without an anchor; errors of those that
/// were found but could not be scored are NaN, means are over scored walls. The common rotation is already taken out.
[[nodiscard]] ContourErrors contour_errors(const RoomAlignment& alignment);

}  // namespace noctule::eval
