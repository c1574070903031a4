#include <gtest/gtest.h>

#include <cmath>

#include "datasets/sonar_bigwheel.hpp"
#include "datasets/sonar_scitos24.hpp"
#include "files.hpp"

namespace noctule::datasets {
namespace {

// Ten steps of a circle to the left, driven by hand: the compass yaw falls while the right wheel runs ahead.
std::string circle_to_the_left() {
  std::string rows = "0,0,170,120,500,60,30,1,2\n";
  for (int i = 1; i <= 10; ++i) {
    const int yaw = (170 - 9 * i + 180 + 360) % 360 - 180;
    rows += "10,18," + std::to_string(yaw) + ",120,523,60,30,1,2\n";
  }
  return rows;
}

TEST(SonarBigwheel, IntegratesTheWaysAlongTheYaw) {
  const TemporaryFolder folder;
  SonarBigwheel source({.path = folder.write("run.txt", circle_to_the_left())});
  const auto observations = all(source);
  const auto odometry = only<Odometry>(observations);
  ASSERT_EQ(odometry.size(), 10u);
  EXPECT_EQ(odometry[0].stamp, (Stamp{200'000, 0}));
  Pose2 pose = source.world().start_in_map;
  for (const Odometry& o : odometry) {
    EXPECT_GT(o.covariance(2, 2), 0.0);
    pose = pose * o.increment;
  }
  // A quarter circle of length 0.7 m to the left.
  const double radius = 0.7 / (0.5 * kPi);
  EXPECT_NEAR(pose.x, radius, 1e-12);
  EXPECT_NEAR(pose.y, radius, 1e-12);
  EXPECT_NEAR(pose.yaw, 0.5 * kPi, 1e-12);
}

TEST(SonarBigwheel, LooksAheadAndBehindAndWhenAskedToTheSides) {
  const TemporaryFolder folder;
  const auto path = folder.write("run.txt", circle_to_the_left());
  SonarBigwheel plain({.path = path, .front_offset = 0.1, .rear_offset = 0.2});
  const auto scans = only<UltrasonicScan>(all(plain));
  ASSERT_EQ(scans.size(), 11u);
  ASSERT_EQ(scans[0].beams.size(), 2u);
  EXPECT_EQ(scans[0].beams[0].echo, Echo::hit);
  EXPECT_DOUBLE_EQ(scans[0].beams[0].range, 1.2);
  EXPECT_DOUBLE_EQ(scans[0].beams[0].sensor_in_base.x, 0.1);
  EXPECT_EQ(scans[0].beams[1].echo, Echo::none);
  EXPECT_NEAR(scans[0].beams[1].sensor_in_base.x, -0.2, 1e-15);

  SonarBigwheel both({.path = path, .infrared = true});
  const auto with_sides = only<UltrasonicScan>(all(both));
  ASSERT_EQ(with_sides.size(), 22u);
  EXPECT_EQ(with_sides[1].stamp, (Stamp{0, 1}));
  EXPECT_EQ(with_sides[1].beams[0].echo, Echo::none);
  EXPECT_EQ(with_sides[1].beams[1].echo, Echo::hit);
  EXPECT_NEAR(with_sides[1].beams[1].sensor_in_base.yaw, radians(-90.0), 1e-12);
}

TEST(SonarBigwheel, RefusesWhatIsWrong) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& rows) {
    const auto path = folder.write("run.txt", rows);
    return refusal([&] { SonarBigwheel({.path = path}); }).substr(path.string().size());
  };
  EXPECT_EQ(refused("112,65,84,0,0\n"), ":1: expected 9 columns, got 5");
  EXPECT_EQ(refused("0,0,1,2,3,4,5,6,7\n0,0,1,-2,3,4,5,6,7\n"), ":2: front_cm: expected at least 0, got -2");
  EXPECT_EQ(refused("0,0.5,1,2,3,4,5,6,7\n"), ":1: right_ticks: expected an integer, got 0.5");
  EXPECT_EQ(refused("0,nan,1,2,3,4,5,6,7\n"), ":1: right_ticks: expected a finite number, got 'nan'");
}

TEST(SonarScitos24, LooksClockwiseFromAhead) {
  const TemporaryFolder folder;
  std::string header, row;
  for (int i = 1; i <= 24; ++i) {
    header += "S" + std::to_string(i) + ",";
    row += (i == 24 ? "5.0" : i == 3 ? "5.02" : std::to_string(0.1 * i)) + ",";
  }
  const std::string content = header + "OUTPUT\n" + row + "Move-Forward\n" + row + "Move-Forward\n";
  SonarScitos24 source({.path = folder.write("s.data", content), .rate = 8.0});
  const auto observations = all(source);
  ASSERT_EQ(observations.size(), 2u);
  const auto scans = only<UltrasonicScan>(observations);
  EXPECT_EQ(scans[1].stamp, (Stamp{125'000, 1}));
  ASSERT_EQ(scans[0].beams.size(), 24u);
  EXPECT_EQ(scans[0].beams[0].echo, Echo::saturated);
  EXPECT_EQ(scans[0].beams[2].echo, Echo::none);
  EXPECT_EQ(scans[0].beams[23].echo, Echo::none);
  EXPECT_EQ(scans[0].beams[6].sensor_in_base.yaw, radians(-90.0));
  EXPECT_NEAR(scans[0].beams[6].range, 0.7, 1e-12);
  EXPECT_NEAR(scans[0].beams[18].sensor_in_base.yaw, radians(90.0), 1e-12);

  EXPECT_NE(refusal([&] { SonarScitos24({.path = folder.write("h.data", row + "Move\n")}); }).find(":1: expected 'S1,"),
            std::string::npos);
}

struct Closure {
  double length = 0.0;
  double gap = 0.0;           // from start to end
  double gap_as_given = 0.0;  // the same as the description integrates: each way along the heading at its end
};
Closure closure(const std::filesystem::path& path) {
  SonarBigwheel source({.path = path});
  Closure c;
  Pose2 pose;
  Vector2 as_given = Vector2::Zero();
  for (const Odometry& o : only<Odometry>(all(source))) {
    c.length += o.increment.position().norm();
    pose = pose * o.increment;
    const double way = std::copysign(o.increment.position().norm(), o.increment.x);
    as_given += way * Vector2(std::cos(pose.yaw), std::sin(pose.yaw));
  }
  c.gap = pose.position().norm();
  c.gap_as_given = as_given.norm();
  return c;
}

TEST(RecordedSonarBigwheel, ComesBackToItsStartAsItsDescriptionSays) {
  NOCTULE_RECORDED(folder, "sonar-bigwheel");
  struct Run {
    const char* name;
    double length, gap;
  };
  for (const Run& run : {Run{"Garden_small.txt", 10.2, 0.54}, Run{"Garden_27_03_20.txt", 36.0, 0.74},
                         Run{"Garden_10_04_20.txt", 71.0, 0.85}}) {
    const Closure c = closure(folder / run.name);
    EXPECT_NEAR(c.length, run.length, 0.5) << run.name;
    EXPECT_NEAR(c.gap_as_given, run.gap, 0.05) << run.name;
    EXPECT_LT(c.gap, 1.3) << run.name;
  }
}

TEST(RecordedSonarScitos24, IsAsItsDescriptionSays) {
  NOCTULE_RECORDED(folder, "sonar-scitos24");
  SonarScitos24 source({.path = folder / "sensor_readings_24.data"});
  EXPECT_TRUE(source.notes().empty());
  const auto scans = only<UltrasonicScan>(all(source));
  ASSERT_EQ(scans.size(), 5456u);
  EXPECT_NEAR(seconds(scans.back().stamp.utime), 606.0, 1.0);
  double least = 1.0, most = 0.0;
  for (std::size_t i = 0; i < 24; ++i) {
    int none = 0;
    for (const UltrasonicScan& s : scans) none += s.beams[i].echo == Echo::none;
    least = std::min(least, none / 5456.0);
    most = std::max(most, none / 5456.0);
  }
  EXPECT_NEAR(least, 0.01, 0.01);
  EXPECT_NEAR(most, 0.36, 0.01);
}

}  // namespace
}  // namespace noctule::datasets
