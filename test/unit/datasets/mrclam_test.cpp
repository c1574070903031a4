#include "datasets/mrclam.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "files.hpp"

namespace noctule::datasets {
namespace {

class MrclamTest : public testing::Test {
 protected:
  MrclamTest() {
    folder_.write("Barcodes.dat", "# Subject Barcode\n1 5\n2 14\n6 63\n11 27\n17 16\n");
    folder_.write("Landmark_Groundtruth.dat", "# c\n6 1 2 0.001 0.001\n11 3 4 0.001 0.001\n17 5 6 0.001 0.001\n");
    folder_.write("Robot1_Odometry.dat", "# c\n100.0 0.5 0.0\n101.0 0.5 0.5\n102.0 0.0 0.5\n103.0 0 0\n");
    folder_.write("Robot1_Measurement.dat",
                  "# c\n99.0 63 1 0\n101.5 63 2.0 0.25\n101.5 14 2.0 0.5\n101.5 27 4.0 -0.25\n101.7 99 1 1\n"
                  "102.5 16 1.0 3.0\n104 63 1 0\n");
    folder_.write("Robot1_Groundtruth.dat", "# c\n98 0 0 3.0\n102 1 2 -3.0\n103 2 2 -3.0\n200 0 0 0\n");
  }
  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string refused(const MrclamParameters& p) const {
    return refusal([&] { Mrclam{p}; });
  }
  TemporaryFolder folder_;
};

TEST_F(MrclamTest, HoldsEachCommandUntilTheNextOneAndStopsAtSightings) {
  Mrclam source({.path = folder_.path()});
  const auto odometry = only<Odometry>(all(source));
  ASSERT_EQ(odometry.size(), 5u);  // at 101, 101.5 (sighting), 102, 102.5 (sighting), 103
  EXPECT_EQ(odometry[1].stamp, (Stamp{101'500'000, 1}));
  EXPECT_LT(difference(odometry[0].increment, {0.5, 0.0, 0.0}).norm(), 1e-12);
  Pose2 bend = odometry[1].increment * odometry[2].increment;
  EXPECT_NEAR(bend.yaw, 0.5, 1e-12);
  EXPECT_NEAR(bend.x, std::sin(0.5), 1e-12);  // an arc of radius 1
  EXPECT_NEAR(bend.y, 1.0 - std::cos(0.5), 1e-12);
  EXPECT_LT(difference(odometry[3].increment * odometry[4].increment, {0.0, 0.0, 0.5}).norm(), 1e-12);
  EXPECT_GT(odometry[4].covariance(2, 2), 0.0);
}

TEST_F(MrclamTest, GroupsTheSightingsOfOneFrameAndDropsOthersWithANote) {
  Mrclam source({.path = folder_.path()});
  ASSERT_EQ(source.notes().size(), 1u);
  EXPECT_NE(source.notes()[0].find("left out 1 sightings of robots, 1 of bar codes of nobody, 2 of landmarks outside"),
            std::string::npos)
      << source.notes()[0];
  const auto frames = only<LandmarkDetections>(all(source));
  ASSERT_EQ(frames.size(), 2u);
  ASSERT_EQ(frames[0].detections.size(), 2u);
  EXPECT_EQ(frames[0].detections[0].id, 6);
  EXPECT_EQ(frames[0].detections[1].id, 11);
  EXPECT_EQ(frames[0].detections[1].range, 4.0);
  EXPECT_EQ(frames[0].detections[1].bearing, -0.25);
  EXPECT_NEAR(std::sqrt(frames[0].detections[1].covariance(0, 0)), 0.05 + 0.03 * 4.0, 1e-12);
  EXPECT_EQ(frames[1].detections[0].id, 17);

  Mrclam unknown({.path = folder_.path(), .known_ids = false});
  for (const auto& f : only<LandmarkDetections>(all(unknown))) {
    for (const auto& d : f.detections) EXPECT_EQ(d.id, -1);
  }
}

TEST_F(MrclamTest, TruthIsThatOfTheRunAndItsStartInterpolatedAcrossTheWrap) {
  Mrclam source({.path = folder_.path()});
  EXPECT_NEAR(source.world().start_in_map.x, 0.5, 1e-12);
  EXPECT_NEAR(wrap(source.world().start_in_map.yaw - kPi), 0.0, 1e-12);
  const auto truth = only<GroundTruth>(all(source));
  ASSERT_EQ(truth.size(), 2u);
  EXPECT_EQ(truth[0].stamp, (Stamp{102'000'000, 0}));
}

TEST_F(MrclamTest, WorksWithoutTruth) {
  std::filesystem::remove(folder_.path() / "Robot1_Groundtruth.dat");
  Mrclam source({.path = folder_.path()});
  EXPECT_EQ(source.notes().size(), 2u);
  EXPECT_EQ(source.world().start_in_map, Pose2{});
  EXPECT_TRUE(only<GroundTruth>(all(source)).empty());
}

TEST_F(MrclamTest, SwapsTheTwoLandmarksOfSetOneOnlyWhenAsked) {
  const auto place = [&](bool swap, std::int64_t id) {
    const Mrclam source({.path = folder_.path(), .swap_11_17 = swap});
    const auto& landmarks = source.world().landmarks;
    return std::find_if(landmarks.begin(), landmarks.end(), [&](const auto& l) { return l.id == id; })->position;
  };
  EXPECT_EQ(place(false, 11), Vector2(3, 4));
  EXPECT_EQ(place(true, 11), Vector2(5, 6));
  EXPECT_EQ(place(true, 17), Vector2(3, 4));
  EXPECT_EQ(place(true, 6), Vector2(1, 2));
}

TEST_F(MrclamTest, SpreadsTruthInWholeSeconds) {
  std::filesystem::remove(folder_.path() / "Robot1_Groundtruth.dat");
  folder_.write("Robot1_Groundtruth_int_seconds.csv",
                "\xEF\xBB\xBFTime,X,Y,Orientation\n101,0,0,0\n101,1,0,0\n101,2,0,0\n101,3,0,0\n102,4,0,0\n102,5,0,0\n");
  Mrclam whole({.path = folder_.path()});
  EXPECT_NE(whole.notes().back().find("left out 4 poses at the time of the one before"), std::string::npos);
  EXPECT_EQ(only<GroundTruth>(all(whole)).size(), 2u);
  Mrclam spread({.path = folder_.path(), .spread_seconds = true});
  const auto truth = only<GroundTruth>(all(spread));
  ASSERT_EQ(truth.size(), 6u);
  const std::int64_t expected[] = {100'625'000, 100'875'000, 101'125'000, 101'375'000, 101'750'000, 102'250'000};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(truth[i].stamp.utime, expected[i]);
    EXPECT_EQ(truth[i].base_in_map.x, static_cast<double>(i));
  }
  folder_.write("Robot1_Groundtruth_int_seconds.csv", "Time,X,Y,Orientation\n101.5,0,0,0\n");
  EXPECT_EQ(
      refused({.path = folder_.path(), .spread_seconds = true}),
      file("Robot1_Groundtruth_int_seconds.csv") + ":2: time_s: expected whole seconds (spread_seconds), got 101.5");
}

TEST_F(MrclamTest, ReadsCompressedFiles) {
  std::filesystem::remove(folder_.path() / "Robot1_Odometry.dat");
  gzFile gz = gzopen(file("Robot1_Odometry.dat.gz").c_str(), "wb");
  gzputs(gz, "# c\n100.0 1 0\n103.0 0 0\n");
  gzclose(gz);
  Mrclam source({.path = folder_.path()});
  Pose2 pose;
  for (const Odometry& o : only<Odometry>(all(source))) pose = pose * o.increment;
  EXPECT_NEAR(pose.x, 3.0, 1e-12);
}

TEST_F(MrclamTest, RefusesWhatIsWrong) {
  const MrclamParameters p{.path = folder_.path()};
  EXPECT_EQ(refused({.path = folder_.path(), .robot = 2}),
            folder_.path().string() + ": expected a file Robot2_Odometry.dat or Robot2_Odometry.dat.gz, got neither");
  EXPECT_EQ(refused({}), "path: expected the folder of an MR.CLAM data set, got ''");
  folder_.write("Robot1_Measurement.dat", "101 63 1 0\n100.5 63 1 0\n");
  EXPECT_EQ(refused(p), file("Robot1_Measurement.dat") + ":2: time_s: expected at least 101 as above, got 100.5");
  folder_.write("Robot1_Measurement.dat", "101 63 -1 0\n");
  EXPECT_EQ(refused(p), file("Robot1_Measurement.dat") + ":1: range_m: expected at least 0, got -1");
  folder_.write("Robot1_Measurement.dat", "101 63.5 1 0\n");
  EXPECT_EQ(refused(p), file("Robot1_Measurement.dat") + ":1: barcode: expected an integer, got 63.5");
  folder_.write("Barcodes.dat", "1 5\n2 5\n");
  EXPECT_EQ(refused(p), file("Barcodes.dat") + ":2: barcode: expected each bar code once, got 5");
  folder_.write("Landmark_Groundtruth.dat", "6 1 2 0.1 0.1\n17 1 2 0.1 0.1\n");
  EXPECT_NE(refused({.path = folder_.path(), .swap_11_17 = true}).find("expected landmarks 11 and 17, got no 11"),
            std::string::npos);
}

// ---- the recorded sets ----

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + v.size() / 2, v.end());
  return v[v.size() / 2];
}
double mean(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}
double deviation(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += std::pow(x - mean(v), 2);
  return std::sqrt(sum / static_cast<double>(v.size()));
}
double robust_deviation(std::vector<double> v) {
  const double m = median(v);
  for (double& x : v) x = std::abs(x - m);
  return 1.4826 * median(v);
}

// Between truth poses at most `max_gap` [s] apart.
std::optional<Pose2> true_pose(const std::vector<GroundTruth>& truth, std::int64_t utime, double max_gap) {
  const auto b = std::upper_bound(truth.begin(), truth.end(), utime,
                                  [](std::int64_t u, const GroundTruth& t) { return u < t.stamp.utime; });
  if (b == truth.begin() || b == truth.end()) return std::nullopt;
  const auto a = b - 1;
  const double gap = seconds(b->stamp.utime - a->stamp.utime);
  if (gap > max_gap) return std::nullopt;
  const Vector3 d = seconds(utime - a->stamp.utime) / gap * difference(b->base_in_map, a->base_in_map);
  return Pose2{a->base_in_map.x + d.x(), a->base_in_map.y + d.y(), wrap(a->base_in_map.yaw + d.z())};
}

struct Residuals {
  std::vector<double> range, bearing;
  double dead_reckoning_rms = 0.0, dead_reckoning_max = 0.0;
};

// Sightings against the true poses and places; dead reckoning against the true path.
Residuals residuals(const MrclamParameters& p) {
  constexpr double kMaxGap = 0.1;
  Mrclam source(p);
  const KnownWorld world = source.world();
  std::map<std::int64_t, Vector2> places;
  for (const KnownLandmark& l : world.landmarks) places[l.id] = l.position;
  const auto observations = all(source);
  const auto truth = only<GroundTruth>(observations);
  Residuals r;
  Pose2 dead_reckoning = world.start_in_map;
  double squares = 0.0;
  int poses = 0;
  for (const Observation& o : observations) {
    if (const auto* odometry = std::get_if<Odometry>(&o)) {
      dead_reckoning = dead_reckoning * odometry->increment;
      const auto pose = true_pose(truth, odometry->stamp.utime, kMaxGap);
      if (!pose) continue;
      const double error = (dead_reckoning.position() - pose->position()).norm();
      squares += error * error;
      ++poses;
      r.dead_reckoning_max = std::max(r.dead_reckoning_max, error);
    } else if (const auto* frame = std::get_if<LandmarkDetections>(&o)) {
      const auto pose = true_pose(truth, frame->stamp.utime, kMaxGap);
      if (!pose) continue;
      for (const LandmarkDetection& d : frame->detections) {
        const Vector2 seen = inverse(*pose) * places.at(d.id);
        r.range.push_back(d.range - seen.norm());
        r.bearing.push_back(wrap(d.bearing - std::atan2(seen.y(), seen.x())));
      }
    }
  }
  r.dead_reckoning_rms = std::sqrt(squares / poses);
  return r;
}

TEST(RecordedMrclam6, HasTheErrorsItsDescriptionLists) {
  NOCTULE_RECORDED(folder, "mrclam6");
  struct Row {
    int robot, sightings;
    double range_bias, range_robust, range_sd, bearing_bias, bearing_robust, bearing_sd, rms, max;
  };
  const Row rows[] = {{1, 1531, 0.039, 0.079, 0.122, -0.000, 0.011, 0.019, 2.6, 8.3},
                      {2, 3232, 0.030, 0.179, 0.189, 0.003, 0.009, 0.012, 3.0, 9.0},
                      {3, 4335, -0.022, 0.128, 0.167, -0.002, 0.006, 0.091, 4.2, 8.6},
                      {4, 2022, 0.067, 0.095, 0.157, -0.014, 0.011, 0.011, 1.8, 4.3},
                      {5, 4217, 0.002, 0.134, 0.214, -0.001, 0.006, 0.096, 1.8, 4.3}};
  for (const Row& row : rows) {
    SCOPED_TRACE("robot " + std::to_string(row.robot));
    const Residuals r = residuals({.path = folder, .robot = row.robot});
    EXPECT_EQ(std::ssize(r.range), row.sightings);
    EXPECT_NEAR(median(r.range), row.range_bias, 0.02);
    EXPECT_NEAR(robust_deviation(r.range), row.range_robust, 0.005);
    EXPECT_NEAR(deviation(r.range), row.range_sd, 0.005);
    EXPECT_NEAR(median(r.bearing), row.bearing_bias, 0.002);
    EXPECT_NEAR(robust_deviation(r.bearing), row.bearing_robust, 0.002);
    EXPECT_NEAR(deviation(r.bearing), row.bearing_sd, 0.002);
    EXPECT_NEAR(r.dead_reckoning_rms, row.rms, 0.1);
    EXPECT_NEAR(r.dead_reckoning_max, row.max, 0.1);
  }
}

// Mean normalised squared error of the odometry over windows of 5 s, per degree of freedom.
double odometry_consistency(const MrclamParameters& p) {
  constexpr double kWindow = 5.0, kMaxGap = 0.1;
  Mrclam source(p);
  std::optional<GroundTruth> begin, last;
  PoseGaussian motion;
  double sum = 0.0;
  int windows = 0;
  while (const auto o = source.next()) {
    if (const auto* odometry = std::get_if<Odometry>(&*o)) {
      motion = motion * PoseGaussian{odometry->increment, odometry->covariance};
    } else if (const auto* truth = std::get_if<GroundTruth>(&*o)) {
      const bool hole = last && seconds(truth->stamp.utime - last->stamp.utime) > kMaxGap;
      last = *truth;
      const bool full = begin && seconds(truth->stamp.utime - begin->stamp.utime) >= kWindow;
      if (begin && !hole && !full) continue;
      if (full && !hole) {
        const Vector3 error = difference(motion.mean, between(begin->base_in_map, truth->base_in_map));
        const Matrix3 covariance = motion.covariance + 1e-4 * Matrix3::Identity();  // 1 cm, 0.6 deg: pairing in time
        sum += error.dot(covariance.ldlt().solve(error)) / 3.0;
        ++windows;
      }
      begin = *truth;
      motion = {};
    }
  }
  return sum / windows;
}

TEST(RecordedMrclam6, OdometryIsAboutAsUncertainAsItSays) {
  NOCTULE_RECORDED(folder, "mrclam6");
  for (int robot = 1; robot <= 5; ++robot) {
    const double nees = odometry_consistency({.path = folder, .robot = robot});
    EXPECT_GT(nees, 0.5) << robot;
    EXPECT_LT(nees, 1.5) << robot;
  }
}

TEST(RecordedMrclam1, FitsOnlyWithTheTwoLandmarksSwappedAndTheSecondsSpread) {
  NOCTULE_RECORDED(folder, "mrclam1-robot1");
  const auto outliers = [](const std::vector<double>& v) {
    return static_cast<double>(std::count_if(v.begin(), v.end(), [](double x) { return std::abs(x) > 0.7; })) /
           static_cast<double>(v.size());
  };
  const Residuals good = residuals({.path = folder, .swap_11_17 = true, .spread_seconds = true});
  Mrclam source({.path = folder});
  std::size_t sightings = 0;
  for (const LandmarkDetections& f : only<LandmarkDetections>(all(source))) sightings += f.detections.size();
  EXPECT_EQ(sightings, 4771u);
  EXPECT_NEAR(median(good.range), 0.01, 0.01);
  EXPECT_LT(robust_deviation(good.range), 0.11);
  EXPECT_LT(robust_deviation(good.bearing), 0.031);
  EXPECT_LT(outliers(good.range), 0.02);
  EXPECT_GT(outliers(residuals({.path = folder, .spread_seconds = true}).range), 0.1);
}

}  // namespace
}  // namespace noctule::datasets
