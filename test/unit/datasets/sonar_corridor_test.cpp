#include "datasets/sonar_corridor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "files.hpp"

namespace noctule::datasets {
namespace {

const char* const kRanges =
    "1000 500 5110 100 2000 2000 2000 2000 900\n"
    "1200 510 5110 5110 1990 2000 2000 2000 910\n"
    "1450 520 5110 5110 1980 2000 2000 2000 920\n";
const char* const kPoses =
    "1000 100 200 900\n"
    "1200 100 300 900\n"
    "1450 100 500 450\n";

class SonarCorridorTest : public testing::Test {
 protected:
  std::vector<Observation> read(const AddedNoise& noise) {
    folder_.write("measurement.txt", kRanges);
    folder_.write("poses.txt", kPoses);
    SonarCorridor source({.path = folder_.path(), .ring_radius = 0.2, .noise = noise});
    start_ = source.world().start_in_map;
    return all(source);
  }
  std::string refused(const std::string& ranges, const std::string& poses) {
    folder_.write("measurement.txt", ranges);
    folder_.write("poses.txt", poses);
    return refusal([&] { SonarCorridor({.path = folder_.path()}); });
  }
  TemporaryFolder folder_;
  Pose2 start_;
};

TEST_F(SonarCorridorTest, GivesScansPosesAndIncrementsInOrder) {
  const auto observations = read({.enabled = false});
  const auto scans = only<UltrasonicScan>(observations);
  const auto odometry = only<Odometry>(observations);
  const auto truth = only<GroundTruth>(observations);
  ASSERT_EQ(scans.size(), 3u);
  ASSERT_EQ(odometry.size(), 2u);
  ASSERT_EQ(truth.size(), 3u);
  EXPECT_TRUE(std::holds_alternative<GroundTruth>(observations[0]));
  EXPECT_TRUE(std::holds_alternative<Odometry>(observations[2]));
  EXPECT_EQ(scans[2].stamp, (Stamp{1450000, 2}));

  ASSERT_EQ(scans[0].beams.size(), 8u);
  const UltrasonicBeam& right = scans[0].beams[0];
  EXPECT_EQ(right.echo, Echo::hit);
  EXPECT_DOUBLE_EQ(right.range, 0.5);
  EXPECT_NEAR(right.sensor_in_base.yaw, radians(-90.0), 1e-15);
  EXPECT_NEAR(right.sensor_in_base.y, -0.2, 1e-15);
  EXPECT_EQ(scans[0].beams[1].echo, Echo::none);
  EXPECT_EQ(scans[0].beams[2].echo, Echo::saturated);
  EXPECT_NEAR(scans[0].beams[7].sensor_in_base.yaw, radians(90.0), 1e-15);

  EXPECT_NEAR(start_.yaw, radians(90.0), 1e-12);
  Pose2 pose = start_;
  for (const Odometry& o : odometry) {
    EXPECT_EQ(o.covariance, Matrix3::Zero());
    pose = pose * o.increment;
  }
  EXPECT_LT(difference(pose, truth[2].base_in_map).norm(), 1e-12);
  EXPECT_NEAR(odometry[0].increment.x, 0.1, 1e-12);
}

TEST_F(SonarCorridorTest, TakesEachPingOnce) {
  const std::vector<int> right{500, 500, 490, 490, 490, 490, 480, 470, 470};
  std::string ranges, poses;
  for (std::size_t i = 0; i < right.size(); ++i) {
    const std::string time = std::to_string(1000 + 200 * i);
    ranges += time + " " + std::to_string(right[i]) + " 5110 900 900 900 900 900 900\n";
    poses += time + " 0 0 0\n";
  }
  folder_.write("measurement.txt", ranges);
  folder_.write("poses.txt", poses);
  SonarCorridor source({.path = folder_.path()});
  const auto scans = only<UltrasonicScan>(all(source));
  const std::vector<bool> fresh{true, false, true, false, true, false, true, true, false};
  ASSERT_EQ(scans.size(), fresh.size());
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    EXPECT_EQ(scans[i].beams[0].echo, fresh[i] ? Echo::hit : Echo::invalid) << i;
    EXPECT_EQ(scans[i].beams[0].range, fresh[i] ? right[i] * 1e-3 : 0.0) << i;
    EXPECT_EQ(scans[i].beams[1].echo, i % 2 == 0 ? Echo::none : Echo::invalid) << i;
  }
}

TEST_F(SonarCorridorTest, AddsNoiseOfExactlyTheStatedCovariance) {
  constexpr int kSteps = 800;
  std::string ranges, poses;
  for (int i = 0; i <= kSteps; ++i) {
    const std::string time = std::to_string(1000 + 200 * i);
    ranges += time + " 500 500 500 500 500 500 500 500\n";
    poses +=
        time + " " + std::to_string(60 * i) + " " + std::to_string(80 * i) + " " + std::to_string(i % 2 * 50) + "\n";
  }
  folder_.write("measurement.txt", ranges);
  folder_.write("poses.txt", poses);
  SonarCorridor exact({.path = folder_.path(), .noise = {.enabled = false}});
  const auto clean = only<Odometry>(all(exact));
  for (const NoiseGrowth growth : {NoiseGrowth::increment, NoiseGrowth::path}) {
    SonarCorridor source({.path = folder_.path(), .noise = {.growth = growth, .seed = 3}});
    const auto noisy = only<Odometry>(all(source));
    ASSERT_EQ(noisy.size(), kSteps);
    // Normalised squared errors of length and heading: each chi-square with 1 degree, their mean has sd 0.05.
    double length = 0.0, heading = 0.0;
    for (std::size_t i = 0; i < noisy.size(); ++i) {
      const Vector2 u = clean[i].increment.position().normalized();
      const Vector2 error = noisy[i].increment.position() - clean[i].increment.position();
      const double turn_error = wrap(noisy[i].increment.yaw - clean[i].increment.yaw);
      const double length_variance = u.dot(noisy[i].covariance.topLeftCorner<2, 2>() * u);
      const double scale = growth == NoiseGrowth::increment ? 0.1 : std::sqrt(0.1);
      ASSERT_NEAR(std::sqrt(length_variance), 0.05 * scale, 1e-12);
      ASSERT_NEAR(std::sqrt(noisy[i].covariance(2, 2)), radians(3.0) * scale, 1e-12);
      ASSERT_LT(std::abs(u.x() * error.y() - u.y() * error.x()), 1e-12);
      length += std::pow(u.dot(error), 2) / length_variance / kSteps;
      heading += turn_error * turn_error / noisy[i].covariance(2, 2) / kSteps;
    }
    EXPECT_NEAR(length, 1.0, 0.2);
    EXPECT_NEAR(heading, 1.0, 0.2);
  }
}

TEST_F(SonarCorridorTest, TheSameSeedAddsTheSameNoise) {
  const auto a = only<Odometry>(read({.seed = 7})), b = only<Odometry>(read({.seed = 7})),
             c = only<Odometry>(read({.seed = 8}));
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].increment, b[i].increment);
    EXPECT_NE(a[i].increment, c[i].increment);
  }
}

TEST_F(SonarCorridorTest, RefusesWhatIsWrong) {
  const std::string ranges = (folder_.path() / "measurement.txt").string();
  const std::string poses = (folder_.path() / "poses.txt").string();
  EXPECT_NE(refusal([&] { SonarCorridor({.path = folder_.path() / "absent"}); }).find("measurement.txt"),
            std::string::npos);
  EXPECT_EQ(refused("1000 500 1 1 1 1 1 1 -5\n", "1000 0 0 0\n"), ranges + ":1: r8_mm: expected at least 0, got -5");
  EXPECT_EQ(refused("1000 500 1 1 1 1 1 1 5\n1000 500 1 1 1 1 1 1 5\n", kPoses),
            ranges + ":2: t_ms: expected more than 1000 as above, got 1000");
  EXPECT_EQ(refused(kRanges, "1000 0 0 0\n1201 0 0 0\n1450 0 0 0\n"),
            poses + ":2: t_ms: expected 1200 as in measurement.txt, got 1201");
  EXPECT_EQ(refused(kRanges, "1000 0 0\n"), poses + ":1: expected 4 columns, got 3");
}

TEST_F(SonarCorridorTest, UsesWhatBothFilesHave) {
  folder_.write("measurement.txt", kRanges);
  folder_.write("poses.txt", std::string(kPoses).substr(0, 30));
  SonarCorridor source({.path = folder_.path()});
  EXPECT_EQ(source.notes().size(), 2u);  // the cut line, and the number of records
  EXPECT_EQ(only<UltrasonicScan>(all(source)).size(), 1u);
}

TEST(RecordedSonarCorridor, IsAsItsDescriptionSays) {
  NOCTULE_RECORDED(folder, "sonar-corridor");
  SonarCorridor source({.path = folder, .noise = {.enabled = false}});
  EXPECT_TRUE(source.notes().empty());
  const Pose2 start = source.world().start_in_map;
  const auto observations = all(source);
  const auto scans = only<UltrasonicScan>(observations);
  const auto truth = only<GroundTruth>(observations);
  ASSERT_EQ(scans.size(), 413u);
  EXPECT_NEAR(seconds(scans.back().stamp.utime - scans.front().stamp.utime), 92.8, 0.05);

  double length = 0.0;
  Pose2 pose = start;
  for (const Odometry& o : only<Odometry>(observations)) {
    length += o.increment.position().norm();
    pose = pose * o.increment;
  }
  EXPECT_NEAR(length, 25.0, 0.05);
  EXPECT_LT(difference(pose, truth.back().base_in_map).norm(), 1e-9);

  // The description counts rows; each ping fills two.
  const double percent_without_echo[] = {14, 30, 25, 43, 80, 30, 30, 5};
  for (std::size_t i = 0; i < 8; ++i) {
    int none = 0, repeated = 0;
    for (const UltrasonicScan& s : scans) {
      none += s.beams[i].echo == Echo::none;
      repeated += s.beams[i].echo == Echo::invalid;
    }
    EXPECT_NEAR(100.0 * none / (413.0 - repeated), percent_without_echo[i], 4.0) << "sensor " << i + 1;
    EXPECT_GT(repeated, 0.35 * 413.0) << "sensor " << i + 1;
    EXPECT_LE(repeated, 0.5 * 413.0) << "sensor " << i + 1;
  }
}

}  // namespace
}  // namespace noctule::datasets
