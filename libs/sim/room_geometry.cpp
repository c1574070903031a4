#include "sim/room_geometry.hpp"

#include <algorithm>
#include <limits>
#include <sstream>

#include "core/error.hpp"

namespace noctule::sim {
namespace {

constexpr double kShortestWall = 0.001;    // [m]; also the least distance of walls that are not neighbours
constexpr double kParallel = 1e-6;         // sine of the angle under which neighbouring lines still meet
constexpr double kSharpestCorner = 0.017;  // [rad], about one degree

double cross(const Vector2& a, const Vector2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool segments_cross(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

double distance_to_segment(const Vector2& p, const Vector2& a, const Vector2& b) {
  const Vector2 d = b - a;
  const double length2 = d.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp(d.dot(p - a) / length2, 0.0, 1.0) : 0.0;
  return (p - a - s * d).norm();
}

double distance_of_segments(const Vector2& a, const Vector2& b, const Vector2& c, const Vector2& d) {
  if (segments_cross(a, b, c, d)) return 0.0;
  return std::min({distance_to_segment(a, c, d), distance_to_segment(b, c, d), distance_to_segment(c, a, b),
                   distance_to_segment(d, a, b)});
}

std::string name_or_number(const std::string& name, std::size_t index) {
  return name.empty() ? std::to_string(index + 1) : name;
}

template <class Item>
std::string check_names(const std::vector<Item>& items, const char* key) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (items[i].name != items[k].name) continue;
      return std::string(key) + ": expected different names, got '" + items[i].name + "' twice";
    }
  }
  return {};
}

std::string text(const Vector2& p) {
  std::ostringstream out;
  out << "(" << 100.0 * p.x() << ", " << 100.0 * p.y() << ") cm";
  return out.str();
}

/// Where the lines of two neighbouring walls meet.
Vector2 intersection(const WallParameters& a, const WallParameters& b) {
  const double determinant = std::sin(b.theta - a.theta);
  if (std::abs(determinant) < kParallel) {
    std::ostringstream out;
    out << "walls: expected each wall to meet the next, got parallel ones at theta_deg = " << degrees(a.theta)
        << " and " << degrees(b.theta);
    throw InputError(out.str());
  }
  return Vector2(a.rho * std::sin(b.theta) - b.rho * std::sin(a.theta),
                 b.rho * std::cos(a.theta) - a.rho * std::cos(b.theta)) /
         determinant;
}

/// Walls from corner to corner in the order given; normals are set when the sense of rotation is known.
std::vector<WallSegment> chain(const RoomParameters& room) {
  if (room.corners.empty() == room.walls.empty()) {
    throw InputError(std::string("expected either corners or walls, got ") + (room.walls.empty() ? "neither" : "both"));
  }
  const bool by_corners = room.walls.empty();
  const std::size_t n = by_corners ? room.corners.size() : room.walls.size();
  if (n < 3) {
    throw InputError(std::string(by_corners ? "corners" : "walls") + ": expected at least 3, got " + std::to_string(n));
  }
  std::vector<WallSegment> walls(n);
  for (std::size_t i = 0; i < n; ++i) {
    walls[i].name = name_or_number(by_corners ? room.corners[i].wall : room.walls[i].name, i);
    walls[i].from = by_corners ? room.corners[i].position : intersection(room.walls[(i + n - 1) % n], room.walls[i]);
    walls[(i + n - 1) % n].to = walls[i].from;
  }
  return walls;
}

}  // namespace

RoomGeometry::RoomGeometry(const RoomParameters& room) : walls_(chain(room)) {
  for (std::size_t i = 0; i < room.cylinders.size(); ++i) {
    const auto& c = room.cylinders[i];
    cylinders_.push_back({name_or_number(c.name, i), {c.centre, c.radius}});
  }
  double twice_area = 0.0;
  for (const WallSegment& w : walls_) twice_area += cross(w.from, w.to);
  const double sense = twice_area < 0.0 ? -1.0 : 1.0;
  const std::size_t n = walls_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const WallSegment &before = walls_[(i + n - 1) % n], &after = walls_[i];
    const Vector2 u = before.to - before.from, v = after.to - after.from;
    const double interior = kPi - sense * std::atan2(cross(u, v), u.dot(v));
    corners_.push_back({after.from, interior});
    convex_ = convex_ && interior <= kPi;
  }
  for (WallSegment& w : walls_) {
    if (sense < 0.0) std::swap(w.from, w.to);
    const Vector2 d = (w.to - w.from).normalized();
    w.normal = {d.y(), -d.x()};
  }
  check_outline();
  check_cylinders();
}

void RoomGeometry::check_outline() const {
  for (const WallSegment& w : walls_) {
    if ((w.to - w.from).norm() < kShortestWall) {
      throw InputError("wall '" + w.name + "': expected a wall longer than 0.1 cm, got both ends at " + text(w.from));
    }
  }
  const std::size_t n = walls_.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = i + 2; k < n; ++k) {
      if (i == 0 && k == n - 1) continue;  // neighbours
      const WallSegment &a = walls_[i], &b = walls_[k];
      if (distance_of_segments(a.from, a.to, b.from, b.to) > kShortestWall) continue;
      throw InputError("walls: expected an outline that does not cross itself, got walls '" + a.name + "' and '" +
                       b.name + "' that meet");
    }
  }
  for (const Corner& c : corners_) {
    if (c.interior_angle > kSharpestCorner && c.interior_angle < kTwoPi - kSharpestCorner) continue;
    throw InputError("walls: expected a corner that opens by more than a degree, got one that folds back at " +
                     text(c.position));
  }
  if (const std::string problem = check_names(walls_, "walls"); !problem.empty()) throw InputError(problem);
}

void RoomGeometry::check_cylinders() const {
  for (std::size_t i = 0; i < cylinders_.size(); ++i) {
    const auto& [name, cylinder] = cylinders_[i];
    const auto fail = [&name = name](const std::string& problem) {
      throw InputError("cylinder '" + name + "': " + problem);
    };
    if (!contains(cylinder.centre)) fail("expected a centre inside the room, got " + text(cylinder.centre));
    for (const WallSegment& w : walls_) {
      if (distance_to_segment(cylinder.centre, w.from, w.to) < cylinder.radius) {
        fail("expected it inside the room, got one that cuts wall '" + w.name + "'");
      }
    }
    for (std::size_t k = 0; k < i; ++k) {
      if ((cylinders_[k].cylinder.centre - cylinder.centre).norm() < cylinders_[k].cylinder.radius + cylinder.radius) {
        fail("expected it apart from others, got one that overlaps cylinder '" + cylinders_[k].name + "'");
      }
    }
  }
  if (const std::string problem = check_names(cylinders_, "cylinders"); !problem.empty()) throw InputError(problem);
}

bool RoomGeometry::contains(const Vector2& p) const {
  bool inside = false;
  for (const WallSegment& w : walls_) {
    if ((w.from.y() > p.y()) == (w.to.y() > p.y())) continue;
    const double x = w.from.x() + (p.y() - w.from.y()) / (w.to.y() - w.from.y()) * (w.to.x() - w.from.x());
    if (p.x() < x) inside = !inside;
  }
  return inside;
}

Clearance RoomGeometry::clearance(const Vector2& a, const Vector2& b) const {
  Clearance nearest{std::numeric_limits<double>::infinity(), {}};
  const auto take = [&nearest](double distance, const char* kind, const std::string& name) {
    if (distance < nearest.distance) nearest = {distance, kind + (" '" + name + "'")};
  };
  for (const WallSegment& w : walls_) take(distance_of_segments(a, b, w.from, w.to), "wall", w.name);
  for (const auto& [name, c] : cylinders_) take(distance_to_segment(c.centre, a, b) - c.radius, "cylinder", name);
  return nearest;
}

bool RoomGeometry::sees(const Vector2& inside, const Vector2& on_outline) const {
  const Vector2 just_before = on_outline + 1e-6 * (inside - on_outline);
  return std::ranges::none_of(walls_,
                              [&](const WallSegment& w) { return segments_cross(inside, just_before, w.from, w.to); });
}

Room RoomGeometry::known_room() const {
  Room room;
  room.cylinders = cylinders_;
  for (const WallSegment& w : walls_) {
    const Wall wall = normalised({w.normal.dot(w.from), std::atan2(w.normal.y(), w.normal.x())});
    const double a = wall.tangent().dot(w.from), b = wall.tangent().dot(w.to);
    room.walls.push_back({w.name, wall, std::min(a, b), std::max(a, b)});
  }
  return room;
}

}  // namespace noctule::sim
