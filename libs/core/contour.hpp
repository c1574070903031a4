#pragma once
/// Maps of a room's contour: estimated ones, and the known one that they are judged against.
#include <string>
#include <vector>

#include "core/features.hpp"

namespace noctule {

/// An estimated wall. Ends are coordinates along tangent() measured from the foot of the perpendicular rho * n.
struct WallEstimate {
  Wall wall;                             ///< map frame, rho >= 0
  Matrix2 covariance = Matrix2::Zero();  ///< order (rho, theta)
  double begin = 0.0;                    ///< [m] extent of what was observed
  double end = 0.0;                      ///< [m]
  int readings = 0;
  int stops = 0;
};

struct CylinderEstimate {
  Cylinder cylinder;                     ///< map frame
  Matrix3 covariance = Matrix3::Zero();  ///< order (x, y, radius)
  double viewing_angle = 0.0;            ///< [rad] of the circle seen; the radius means little below 2 rad
  int readings = 0;
  int stops = 0;
};

/// A corner or an edge: echoes as a circle of radius 0.
struct PointEstimate {
  Vector2 position = Vector2::Zero();
  Matrix2 covariance = Matrix2::Zero();
  int readings = 0;
  int stops = 0;
};

struct ContourMap {
  Stamp stamp;
  std::vector<WallEstimate> walls;
  std::vector<CylinderEstimate> cylinders;
  std::vector<PointEstimate> points;
};

/// A known room in the map frame. Walls in the order of their names, with true ends (see WallEstimate).
struct RoomWall {
  std::string name;
  Wall wall;
  double begin = 0.0;
  double end = 0.0;
};
struct RoomCylinder {
  std::string name;
  Cylinder cylinder;
};
struct Room {
  std::vector<RoomWall> walls;
  std::vector<RoomCylinder> cylinders;
};

}  // namespace noctule
