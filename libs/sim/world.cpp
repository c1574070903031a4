#include "sim/world.hpp"

#include <optional>
#include <sstream>

#include "core/error.hpp"
#include "sim/room_geometry.hpp"
#include "sim/wall_pictures.hpp"

namespace noctule::sim {
namespace {

std::string check_way(const RoomGeometry& room, const Vector2& a, const Vector2& b, const std::string& what) {
  std::ostringstream place;
  place << "(" << 100.0 * b.x() << ", " << 100.0 * b.y() << ") cm";
  if (!room.contains(b)) return what + ": expected a place inside the room, got " + place.str();
  const auto problem = [&](const Clearance& c, const std::string& got) {
    std::ostringstream out;
    out << what << ": expected at least " << 100.0 * kPathClearance << " cm from every obstacle, got " << got << " ";
    if (c.distance < 0.0) {
      out << "inside " << c.obstacle;
    } else {
      out << 100.0 * c.distance << " cm from " << c.obstacle;
    }
    return out.str();
  };
  if (const Clearance c = room.clearance(b, b); c.distance < kPathClearance) return problem(c, place.str());
  if (const Clearance c = room.clearance(a, b); c.distance < kPathClearance) {
    return problem(c, "a way to " + place.str() + " that passes");
  }
  return {};
}

}  // namespace

std::string RoomParameters::validate() const {
  try {
    const RoomGeometry geometry(*this);
    static_cast<void>(hang_pictures(*this, geometry));
    for (const CylinderParameters& c : cylinders) {
      if (c.colour.size() == 3) continue;
      return "cylinders.colour_rgb: expected red, green and blue, got " + std::to_string(c.colour.size()) + " numbers";
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

std::string WorldParameters::validate() const {
  std::optional<RoomGeometry> geometry;
  try {
    geometry.emplace(room);
  } catch (const InputError&) {
    return {};  // said by the room itself
  }
  std::string problem = check_way(*geometry, path.start.position(), path.start.position(), "path.start_cm_deg");
  for (std::size_t i = 0; i < path.waypoints.size() && problem.empty(); ++i) {
    const Vector2 before = i == 0 ? path.start.position() : path.waypoints[i - 1];
    problem = check_way(*geometry, before, path.waypoints[i], "path.waypoints_cm[" + std::to_string(i) + "]");
  }
  if (problem.empty() && path.loops > 1 && !path.waypoints.empty()) {
    problem =
        check_way(*geometry, path.waypoints.back(), path.waypoints.front(), "path.loops, back to the first way-point");
  }
  return problem;
}

}  // namespace noctule::sim
