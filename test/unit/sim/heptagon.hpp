#pragma once
/// The indoor experiment of Yuan et al., section 2.3, in code: the same as config/worlds/heptagon.yaml and
/// config/robots/paper002.yaml, for tests that read no files.
#include "sim/robot.hpp"
#include "sim/world.hpp"

namespace noctule::sim::test {

/// Tables 3 and 4, column 'true value'.
inline RoomParameters heptagon_room() {
  RoomParameters room;
  const double lines[7][2] = {{60.0, 270.0},  {207.846, 330.0}, {300.0, 360.0}, {353.06, 30.0},
                              {263.82, 90.0}, {144.853, 144.0}, {60.0, 180.0}};
  for (const auto& [rho_cm, theta_deg] : lines) room.walls.push_back({"", 0.01 * rho_cm, radians(theta_deg)});
  room.cylinders = {{"", {0.6, 0.6}, 0.106346}, {"", {1.8, 1.2}, 0.14444}};
  return room;
}

inline WorldParameters heptagon() {
  WorldParameters world;
  world.name = "heptagon";
  world.room = heptagon_room();
  const double waypoints[9][2] = {{0, 0},     {150, 0}, {222, 45}, {252, 130}, {225, 200},
                                  {110, 205}, {0, 165}, {-5, 60},  {0, 0}};
  for (const auto& [x_cm, y_cm] : waypoints) world.path.waypoints.push_back(0.01 * Vector2(x_cm, y_cm));
  world.path.loops = 2;
  world.path.stop_spacing = 0.12;
  world.path.scans_at_start = 10;
  return world;
}

inline RobotParameters paper002() {
  RobotParameters robot;
  robot.name = "paper002";
  robot.sonar.mixture = {{0.85, 1.0}, {0.15, 5.0}};
  robot.sonar.schedule = {{0.0, 1.0}, {1.0 / 3.0, 4.0}, {2.0 / 3.0, 2.0}};
  robot.sonar.outliers = 0.02;
  robot.sonar.scale_error = 0.002;
  return robot;
}

/// Hears every echo inside the cone, without any error.
inline SonarParameters perfect_sonar() {
  SonarParameters sonar;
  sonar.hit = {1.0, 1.0, 0.0, false};
  sonar.mixture = {{1.0, 0.0}};
  sonar.quantisation = 0.0;
  return sonar;
}

}  // namespace noctule::sim::test
