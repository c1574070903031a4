#pragma once
/// The geometry of a room: where its walls begin and end, what is inside, what is in the way.
#include <span>
#include <string>
#include <vector>

#include "core/contour.hpp"
#include "sim/world.hpp"

namespace noctule::sim {

/// A wall with the room on its left on the way from `from` to `to`.
struct WallSegment {
  std::string name;
  Vector2 from;
  Vector2 to;
  Vector2 normal;  ///< out of the room
};

/// Where two walls meet.
struct Corner {
  Vector2 position;
  double interior_angle = 0.0;  ///< [rad], above pi for an edge that juts into the room
};

/// How near a way comes to the nearest wall or cylinder.
struct Clearance {
  double distance = 0.0;  ///< [m], negative inside a cylinder
  std::string obstacle;   ///< as in messages: wall '3'
};

class RoomGeometry {
 public:
  /// \throws InputError when the walls do not bound one simple polygon, or a cylinder is not inside or overlaps another
  explicit RoomGeometry(const RoomParameters&);

  [[nodiscard]] std::span<const WallSegment> walls() const { return walls_; }
  /// Corner i lies between wall i - 1 and wall i.
  [[nodiscard]] std::span<const Corner> corners() const { return corners_; }
  [[nodiscard]] std::span<const RoomCylinder> cylinders() const { return cylinders_; }
  [[nodiscard]] bool convex() const { return convex_; }

  /// Inside the outline; cylinders do not count.
  [[nodiscard]] bool contains(const Vector2& point) const;
  /// Of the straight way from a to b, both inside the outline.
  [[nodiscard]] Clearance clearance(const Vector2& a, const Vector2& b) const;
  /// No wall between a point inside and a point of the outline; cylinders do not count.
  [[nodiscard]] bool sees(const Vector2& inside, const Vector2& on_outline) const;

  /// For evaluation: walls with rho >= 0.
  [[nodiscard]] Room known_room() const;

 private:
  void check_outline() const;
  void check_cylinders() const;

  std::vector<WallSegment> walls_;
  std::vector<Corner> corners_;
  std::vector<RoomCylinder> cylinders_;
  bool convex_ = true;
};

}  // namespace noctule::sim
