#pragma once
/// What a simulated world is made of: a polygonal room with cylinders, and the path of the robot through it.
#include <cstdint>
#include <string>
#include <vector>

#include "core/parameters.hpp"
#include "core/pose2.hpp"

namespace noctule::sim {

/// A corner of the room, and the name of the wall that leads from it to the next corner.
struct CornerParameters {
  Vector2 position = Vector2::Zero();
  std::string wall;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("at_cm", &CornerParameters::position, unit::centimetre, "position in the map");
    v.field("wall", &CornerParameters::wall, "name of the wall from here to the next corner; empty: its number");
  }
};

/// The line x cos(theta) + y sin(theta) = rho that a wall lies on.
struct WallParameters {
  std::string name;
  double rho = 0.0;
  double theta = 0.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &WallParameters::name, "name in tables; empty: its number");
    v.field("rho_cm", &WallParameters::rho, unit::centimetre, "distance of the wall's line from the origin");
    v.field("theta_deg", &WallParameters::theta, unit::degree, "direction of the line's normal, from the x axis");
  }
};

struct CylinderParameters {
  std::string name;
  Vector2 centre = Vector2::Zero();
  double radius = 0.0;
  double height = 0.0;
  std::vector<double> colour{150.0, 150.0, 150.0};
  std::int64_t landmark = -1;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &CylinderParameters::name, "name in tables; empty: its number");
    v.field("centre_cm", &CylinderParameters::centre, unit::centimetre, "centre in the map");
    v.field("radius_cm", &CylinderParameters::radius, unit::centimetre, "radius", positive());
    v.field("height_cm", &CylinderParameters::height, unit::centimetre, "for cameras; 0: up to the ceiling",
            at_least(0.0));
    v.field("colour_rgb", &CylinderParameters::colour, unit::one, "for cameras: red, green, blue", between(0.0, 255.0));
    v.field("landmark", &CylinderParameters::landmark, unit::one,
            "number by which cameras know it as a post; -1: they do not", at_least(-1));
  }
};

/// A square picture on a wall. Left and right are as seen from the room.
struct SignParameters {
  std::int64_t landmark = 0;
  std::uint64_t picture = 0;
  std::string wall;
  double offset = 0.0;
  double height = 0.4;
  double size = 0.3;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("landmark", &SignParameters::landmark, unit::one, "number by which cameras know it", at_least(0));
    v.field("picture", &SignParameters::picture, unit::one, "number of the picture (models/sign_picture.hpp)");
    v.field("wall", &SignParameters::wall, "name of the wall it hangs on");
    v.field("offset_cm", &SignParameters::offset, unit::centimetre,
            "its middle from the middle of the wall, to the right");
    v.field("height_cm", &SignParameters::height, unit::centimetre, "its middle over the floor", positive());
    v.field("size_cm", &SignParameters::size, unit::centimetre, "side of the picture", positive());
  }
};

/// A marker of the ArUco dictionary 4x4_50 on a wall.
struct FiducialParameters {
  std::int64_t landmark = 0;
  int marker = 0;
  std::string wall;
  double offset = 0.0;
  double height = 0.4;
  double size = 0.15;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("landmark", &FiducialParameters::landmark, unit::one, "number by which cameras know it", at_least(0));
    v.field("marker", &FiducialParameters::marker, unit::one, "number in the dictionary", between(0, 49));
    v.field("wall", &FiducialParameters::wall, "name of the wall it hangs on");
    v.field("offset_cm", &FiducialParameters::offset, unit::centimetre,
            "its middle from the middle of the wall, to the right");
    v.field("height_cm", &FiducialParameters::height, unit::centimetre, "its middle over the floor", positive());
    v.field("size_cm", &FiducialParameters::size, unit::centimetre, "side of the black square", positive());
  }
};

/// Outline and obstacles. The outline is given either by its corners, or by the lines of its walls, each of which ends
/// where it meets its neighbours in the list; the last is followed by the first. Either sense of rotation.
struct RoomParameters {
  std::vector<CornerParameters> corners;
  std::vector<WallParameters> walls;
  std::vector<CylinderParameters> cylinders;
  double height = 2.5;
  double contrast = 0.06;
  std::vector<SignParameters> signs;
  std::vector<FiducialParameters> fiducials;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.list("corners", &RoomParameters::corners, "corners of the room in order; or give walls instead");
    v.list("walls", &RoomParameters::walls,
           "walls of the room in order, each meeting the next; or give corners instead");
    v.list("cylinders", &RoomParameters::cylinders, "round obstacles");
    v.field("height_cm", &RoomParameters::height, unit::centimetre, "of the ceiling, for cameras", positive());
    v.field("contrast", &RoomParameters::contrast, unit::one,
            "for cameras: how much the grey of walls and floor varies", between(0.0, 1.0));
    v.list("signs", &RoomParameters::signs, "pictures on the walls, for cameras");
    v.list("fiducials", &RoomParameters::fiducials, "markers on the walls, for cameras");
  }
  /// Empty when the outline is one simple polygon with the cylinders inside and apart from each other, and what hangs
  /// on a wall fits there.
  [[nodiscard]] std::string validate() const;
};

/// Way of the robot. It starts at `start`, visits the way-points in order, `loops` times, and stops to listen every
/// `stop_spacing` of the way, at its start and at its end.
struct PathParameters {
  Pose2 start;
  std::vector<Vector2> waypoints;
  int loops = 1;
  double stop_spacing = 0.12;
  int scans_at_start = 1;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("start_cm_deg", &PathParameters::start, unit::centimetre_degree,
            "first pose; filters start here, so let the heading point along the first leg");
    v.field("waypoints_cm", &PathParameters::waypoints, unit::centimetre,
            "places to drive to; none: the robot stays where it is");
    v.field("loops", &PathParameters::loops, unit::one, "times the way-points are visited", at_least(1));
    v.field("stop_spacing_cm", &PathParameters::stop_spacing, unit::centimetre, "way between two stops", at_least(0.1));
    v.field("scans_at_start", &PathParameters::scans_at_start, unit::one, "scans before the first move", at_least(1));
  }
};

struct WorldParameters {
  std::string name = "unnamed";
  RoomParameters room;
  PathParameters path;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &WorldParameters::name, "name in reports");
    v.group("room", &WorldParameters::room, "walls and obstacles");
    v.group("path", &WorldParameters::path, "way of the robot");
  }
  /// Empty when the straight way over the way-points lies inside the room and kPathClearance from everything.
  [[nodiscard]] std::string validate() const;
};

/// Least distance of the sensor's base from walls and cylinders along the way [m].
inline constexpr double kPathClearance = 0.05;

}  // namespace noctule::sim
