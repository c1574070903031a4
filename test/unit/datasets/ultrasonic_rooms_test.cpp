#include "datasets/ultrasonic_rooms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/outline.hpp"
#include "files.hpp"

namespace noctule::datasets {
namespace {

const char* const kHeader = "t_unix_s,yaw_rad,pitch_rad,roll_rad,range_mm,acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z\n";

std::string row(double time, double yaw, int range) {
  return std::to_string(time) + "," + std::to_string(yaw) + ",0,0," + std::to_string(range) + ",0,0,0,0,0,0\n";
}

TEST(UltrasonicRooms, KeepsFreshReadingsAtTheYawOfTheirPing) {
  const TemporaryFolder folder;
  std::string run = kHeader;
  const int ranges[] = {900, 900, 1200, 1200, 5000, 5000, 300, 0, 1300, 1300};
  for (int i = 0; i < 10; ++i) run += row(100.0 + 0.1 * i, 3.0 + 0.05 * i - (i > 2 ? kTwoPi : 0.0), ranges[i]);
  UltrasonicRooms source({.path = folder.write("run.csv", run), .start = {1, 2, 0.5}, .lag = 0.15});
  EXPECT_EQ(source.world().start_in_map, (Pose2{1, 2, 0.5}));
  EXPECT_FALSE(source.world().room.has_value());
  const auto observations = all(source);
  ASSERT_EQ(observations.size(), 1u);
  const auto& scan = std::get<UltrasonicScan>(observations[0]);
  EXPECT_EQ(scan.stamp, (Stamp{100'800'000, 0}));
  ASSERT_EQ(scan.beams.size(), 5u);
  const Echo expected[] = {Echo::hit, Echo::none, Echo::saturated, Echo::invalid, Echo::hit};
  const double rows[] = {2, 4, 6, 7, 8};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(scan.beams[i].echo, expected[i]) << i;
    // Yaw grows clockwise in the file and counter-clockwise in the scan; the ping was 1.5 rows ago.
    EXPECT_NEAR(wrap(scan.beams[i].sensor_in_base.yaw + 3.0 + 0.05 * (rows[i] - 1.5)), 0.0, 1e-5) << i;
  }
  EXPECT_DOUBLE_EQ(scan.beams[0].range, 1.2);
  EXPECT_EQ(scan.beams[1].range, 0.0);
}

TEST(UltrasonicRooms, CutsARunIntoWindows) {
  const TemporaryFolder folder;
  std::string run = kHeader;
  for (int i = 0; i < 40; ++i) run += row(0.1 * i, 0.0, 1000 + i);
  const auto path = folder.write("run.csv", run);
  UltrasonicRooms whole({.path = path}), cut({.path = path, .window = 1.0});
  const auto one = only<UltrasonicScan>(all(whole)), four = only<UltrasonicScan>(all(cut));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].beams.size(), 39u);
  ASSERT_EQ(four.size(), 4u);
  std::size_t beams = 0;
  for (const auto& s : four) beams += s.beams.size();
  EXPECT_EQ(beams, 39u);
  EXPECT_EQ(four[2].stamp, (Stamp{2'900'000, 2}));
}

TEST(UltrasonicRooms, RefusesWhatIsWrong) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& rows) {
    const auto path = folder.write("run.csv", rows);
    return refusal([&] { UltrasonicRooms({.path = path}); }).substr(path.string().size());
  };
  EXPECT_EQ(refused(kHeader + row(1, 0, 900) + row(0.5, 0, 901)),
            ":3: t_unix_s: expected at least 1 as above, got 0.5");
  EXPECT_EQ(refused(kHeader + row(1, 0, 900) + row(2, 0, -1)), ":3: range_mm: expected at least 0, got -1");
  EXPECT_EQ(refused(kHeader + row(1, 0, 900) + row(2, 0, 900)), ": expected ranges that change, got none");
  EXPECT_NE(refused(row(1, 0, 900)).find(":1: expected 't_unix_s,"), std::string::npos);
}

// The free side of each wall is inside, whichever way the corners go round.
TEST(Outline, WallsLieOnTheCornersAndFaceTheInside) {
  std::vector<Vector2> corners{{1, 1}, {3, 1}, {5, 1}, {5, 4}, {3, 4}, {3, 2.5}, {1, 2.5}, {1, 1}};
  for (int sense = 0; sense < 2; ++sense) {
    const Room room = room_from_outline(corners);
    ASSERT_EQ(room.walls.size(), 6u);  // the corner at (3, 1) is on a line
    double perimeter = 0.0;
    for (const RoomWall& w : room.walls) {
      EXPECT_GE(w.wall.rho, 0.0);
      EXPECT_LT(w.begin, w.end);
      perimeter += w.end - w.begin;
      for (const double along : {w.begin, w.end}) {
        const Vector2 end = w.wall.rho * w.wall.normal() + along * w.wall.tangent();
        EXPECT_TRUE(
            std::any_of(corners.begin(), corners.end(), [&](const Vector2& c) { return (c - end).norm() < 1e-9; }));
      }
    }
    EXPECT_NEAR(perimeter, 14.0, 1e-9);
    EXPECT_EQ(room.walls[0].name, "wall 1");
    std::reverse(corners.begin(), corners.end());
  }
}

TEST(Outline, AWallThroughTheOriginPointsOutOfTheRoom) {
  const Room room = room_from_outline(std::vector<Vector2>{{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  ASSERT_EQ(room.walls.size(), 4u);
  EXPECT_EQ(room.walls[0].wall.rho, 0.0);
  EXPECT_NEAR(room.walls[0].wall.theta, -0.5 * kPi, 1e-12);
  EXPECT_NEAR(std::abs(room.walls[3].wall.theta), kPi, 1e-12);
}

TEST(Outline, RefusesWhatEnclosesNothing) {
  EXPECT_THROW(static_cast<void>(room_from_outline(std::vector<Vector2>{{0, 0}, {1, 0}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(room_from_outline(std::vector<Vector2>{{0, 0}, {1, 0}, {2, 0}})),
               std::invalid_argument);
  const TemporaryFolder folder;
  const auto path = folder.write("o.csv", "x_m,y_m\n0,0\n1,1\n");
  EXPECT_EQ(refusal([&] { static_cast<void>(read_outline(path)); }),
            path.string() + ": expected three or more corners around an area, got 2 that enclose none");
}

// Distance from a point to the nearest wall segment inside a cone about a direction.
double first_return(const Room& room, const Vector2& p, double direction, double half_angle) {
  double nearest = 1e9;
  for (int k = -8; k <= 8; ++k) {
    const double a = direction + half_angle * k / 8.0;
    const Vector2 u(std::cos(a), std::sin(a));
    for (const RoomWall& w : room.walls) {
      const double speed = w.wall.normal().dot(u);
      if (std::abs(speed) < 1e-9) continue;
      const double range = w.wall.distance(p) / speed;
      const double along = w.wall.tangent().dot(p + range * u);
      if (range > 0.0 && along >= w.begin && along <= w.end) nearest = std::min(nearest, range);
    }
  }
  return nearest;
}

TEST(RecordedUltrasonicRooms, FitTheTapedOutlineAsTheirDescriptionSays) {
  NOCTULE_RECORDED(folder, "ultrasonic-rooms");
  struct Run {
    const char* name;
    int fresh;
    Vector2 origin;
    double yaw_deg, within;
  };
  const Run runs[] = {{"3", 170, {1.35, 2.98}, -75, 0.62},
                      {"4", 126, {1.43, 2.96}, -76, 0.61},
                      {"5", 130, {1.54, 3.04}, -81, 0.80},
                      {"6", 143, {1.43, 3.03}, -77, 0.64}};
  for (const Run& run : runs) {
    UltrasonicRooms source({.path = folder / "csv" / ("Lvl_1_Room_Map_" + std::string(run.name) + ".csv"),
                            .outline = folder / "room_outline_richards325A.csv",
                            .start = {run.origin.x(), run.origin.y(), radians(run.yaw_deg)}});
    const KnownWorld world = source.world();
    ASSERT_TRUE(world.room.has_value());
    EXPECT_EQ(world.room->walls.size(), 10u);
    const auto observations = all(source);
    ASSERT_EQ(observations.size(), 1u);
    int hits = 0, near = 0;
    for (const UltrasonicBeam& b : std::get<UltrasonicScan>(observations[0]).beams) {
      if (b.echo != Echo::hit) continue;
      ++hits;
      const Pose2 sensor = world.start_in_map * b.sensor_in_base;
      near += std::abs(b.range - first_return(*world.room, sensor.position(), sensor.yaw, radians(7.5))) < 0.2;
    }
    EXPECT_NEAR(hits, run.fresh, 8) << run.name;
    EXPECT_NEAR(static_cast<double>(near) / hits, run.within, 0.12) << run.name;
  }
}

}  // namespace
}  // namespace noctule::datasets
