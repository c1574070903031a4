#include "sim/room_geometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.hpp"
#include "unit/sim/heptagon.hpp"

namespace noctule::sim {
namespace {

/// An L whose corner (2, 2) juts into the room; the origin is outside.
RoomParameters l_room() {
  RoomParameters room;
  const double corners[6][2] = {{1, 1}, {4, 1}, {4, 2}, {2, 2}, {2, 4}, {1, 4}};
  for (const auto& [x, y] : corners) room.corners.push_back({{x, y}, ""});
  return room;
}

TEST(Heptagon, HasTheVerticesAnglesAndLengthsOfThePaper) {
  const RoomGeometry room(test::heptagon_room());
  // Vertex i between wall i and wall i + 1 [cm], lengths [cm], interior angles [deg].
  const double vertices[7][2] = {{205.359, -60},   {300, 103.923}, {300, 186.505}, {255.362, 263.82},
                                 {12.628, 263.82}, {-60, 163.856}, {-60, -60}};
  const double lengths[7] = {265.36, 189.28, 82.58, 89.28, 242.73, 123.56, 223.86};
  const double angles[7] = {120, 150, 150, 120, 126, 144, 90};
  double perimeter = 0.0;
  for (std::size_t i = 0; i < 7; ++i) {
    const Corner& corner = room.corners()[(i + 1) % 7];
    EXPECT_NEAR(100 * corner.position.x(), vertices[i][0], 1e-3) << i;
    EXPECT_NEAR(100 * corner.position.y(), vertices[i][1], 1e-3) << i;
    EXPECT_NEAR(degrees(corner.interior_angle), angles[i], 1e-9) << i;
    const double length = (room.walls()[i].to - room.walls()[i].from).norm();
    EXPECT_NEAR(100 * length, lengths[i], 5e-3) << i;
    perimeter += length;
  }
  EXPECT_NEAR(100 * perimeter, 1216.65, 5e-3);
  EXPECT_TRUE(room.convex());
}

TEST(Heptagon, CylindersHaveTheClearancesOfThePaper) {
  RoomParameters walls_only = test::heptagon_room();
  walls_only.cylinders.clear();
  const RoomGeometry room(walls_only);
  for (const auto& [x, y, radius, clearance_cm] :
       {std::array{0.6, 0.6, 0.106346, 109.4}, std::array{1.8, 1.2, 0.14444, 97.5}}) {
    EXPECT_NEAR(100 * (room.clearance({x, y}, {x, y}).distance - radius), clearance_cm, 0.06);
  }
}

TEST(Heptagon, KnownRoomHoldsThePapersTable) {
  const RoomParameters parameters = test::heptagon_room();
  const Room room = RoomGeometry(parameters).known_room();
  ASSERT_EQ(room.walls.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(room.walls[i].name, std::to_string(i + 1));
    EXPECT_NEAR(room.walls[i].wall.rho, parameters.walls[i].rho, 1e-12);
    EXPECT_NEAR(wrap(room.walls[i].wall.theta - parameters.walls[i].theta), 0.0, 1e-12);
  }
  // Wall 1 runs from (-60, -60) to (205.359, -60); its foot is (0, -60) and its tangent (1, 0).
  EXPECT_NEAR(room.walls[0].begin, -0.6, 1e-12);
  EXPECT_NEAR(room.walls[0].end, 2.05359, 1e-5);
  ASSERT_EQ(room.cylinders.size(), 2u);
  EXPECT_EQ(room.cylinders[1].name, "2");
  EXPECT_EQ(room.cylinders[1].cylinder.radius, 0.14444);
}

TEST(RoomGeometry, CornersAndLinesDescribeTheSameRoom) {
  const RoomGeometry by_lines(test::heptagon_room());
  RoomParameters corners;
  for (const WallSegment& w : by_lines.walls()) corners.corners.push_back({w.from, w.name});
  const RoomGeometry by_corners(corners);
  std::ranges::reverse(corners.corners);
  const RoomGeometry clockwise(corners);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_LT((by_corners.walls()[i].normal - by_lines.walls()[i].normal).norm(), 1e-12);
    EXPECT_LT((by_corners.walls()[i].to - by_lines.walls()[i].to).norm(), 1e-12);
  }
  EXPECT_TRUE(clockwise.convex());
  const Vector2 middle(1.2, 1.0);
  for (const WallSegment& w : clockwise.walls()) EXPECT_GT(w.normal.dot(w.from - middle), 0.0);
}

TEST(RoomGeometry, KnownWallsHaveRhoAtLeastZeroAndTheirOwnEnds) {
  const RoomGeometry geometry(l_room());
  const Room room = geometry.known_room();
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    const auto& [name, wall, begin, end] = room.walls[i];
    EXPECT_GE(wall.rho, 0.0);
    EXPECT_LT(begin, end);
    const Vector2 foot = wall.rho * wall.normal();
    const Vector2 a = foot + begin * wall.tangent(), b = foot + end * wall.tangent();
    const WallSegment& truth = geometry.walls()[i];
    const double same = (a - truth.from).norm() + (b - truth.to).norm();
    const double swapped = (a - truth.to).norm() + (b - truth.from).norm();
    EXPECT_LT(std::min(same, swapped), 1e-12) << name;
  }
}

TEST(RoomGeometry, KnowsInsideClearanceAndSight) {
  const RoomGeometry room(l_room());
  EXPECT_FALSE(room.convex());
  EXPECT_NEAR(degrees(room.corners()[3].interior_angle), 270.0, 1e-9);
  EXPECT_TRUE(room.contains({1.5, 3.5}));
  EXPECT_FALSE(room.contains({3.0, 3.0}));
  EXPECT_FALSE(room.contains({0.0, 0.0}));
  EXPECT_NEAR(room.clearance({1.5, 3.0}, {1.5, 3.0}).distance, 0.5, 1e-12);
  EXPECT_EQ(room.clearance({3.5, 1.2}, {3.0, 1.2}).obstacle, "wall '1'");
  EXPECT_EQ(room.clearance({1.5, 3.5}, {3.5, 1.5}).distance, 0.0);  // cuts the inner corner
  EXPECT_TRUE(room.sees({1.5, 3.5}, {1.5, 1.0}));
  EXPECT_FALSE(room.sees({1.5, 3.5}, {3.5, 1.0}));
  EXPECT_TRUE(room.sees({1.5, 3.5}, {2.0, 2.0}));
}

struct Refusal {
  const char* what;
  RoomParameters room;
};

std::vector<Refusal> refusals() {
  std::vector<Refusal> all;
  const RoomParameters good = test::heptagon_room();
  const auto add = [&](const char* what, auto change) {
    RoomParameters room = good;
    change(room);
    all.push_back({what, room});
  };
  add("expected either corners or walls, got neither", [](auto& r) { r.walls.clear(); });
  add("expected either corners or walls, got both", [](auto& r) { r.corners.resize(1); });
  add("walls: expected at least 3, got 2", [](auto& r) { r.walls.resize(2); });
  add("got parallel ones at theta_deg = 330 and 330", [](auto& r) { r.walls[2].theta = r.walls[1].theta; });
  add("does not cross itself", [](auto& r) { std::swap(r.walls[1], r.walls[3]); });
  add("expected different names, got 'north' twice", [](auto& r) { r.walls[0].name = r.walls[3].name = "north"; });
  add("cylinder '1': expected a centre inside the room, got (600, 60) cm",
      [](auto& r) { r.cylinders[0].centre.x() = 6.0; });
  add("cylinder '2': expected it inside the room, got one that cuts wall '3'", [](auto& r) {
    r.cylinders[1].centre = {2.9, 1.5};
  });
  add("cylinder '2': expected it apart from others, got one that overlaps cylinder '1'",
      [](auto& r) { r.cylinders[1].centre = r.cylinders[0].centre; });
  RoomParameters crossed;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 1.0}, {1.0, 0.0}, {0.0, 1.0}}) {
    crossed.corners.push_back({{x, y}, ""});
  }
  all.push_back({"got walls '1' and '3' that meet", crossed});
  RoomParameters repeated = l_room();
  repeated.corners.push_back(repeated.corners.front());
  all.push_back({"wall '7': expected a wall longer than 0.1 cm, got both ends at (100, 100) cm", repeated});
  RoomParameters folded;
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {1.0, 0.0}}) folded.corners.push_back({{x, y}, ""});
  all.push_back({"folds back", folded});
  return all;
}

TEST(RoomGeometry, RefusesWhatIsNoRoom) {
  for (const auto& [what, room] : refusals()) {
    EXPECT_NE(room.validate().find(what), std::string::npos) << what << "\n got: " << room.validate();
    EXPECT_THROW(RoomGeometry{room}, InputError) << what;
  }
  EXPECT_EQ(test::heptagon_room().validate(), "");
  EXPECT_EQ(l_room().validate(), "");
}

}  // namespace
}  // namespace noctule::sim
