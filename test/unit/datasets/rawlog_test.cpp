#include "datasets/rawlog.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/observation_order.hpp"
#include "core/rng.hpp"
#include "files.hpp"

namespace noctule::datasets {
namespace {

Odometry odometry(std::int64_t utime, const Pose2& increment) {
  Odometry o{{utime, 0}, increment, Matrix3::Zero()};
  o.covariance.diagonal() << 1e-6, 1e-8, 4e-6;
  o.covariance(1, 2) = o.covariance(2, 1) = 1e-8;
  return o;
}

UltrasonicScan ring(std::int64_t utime, Rng& rng) {
  UltrasonicScan scan{{utime, 0}, 0.25, 0.125, 4.0, {}};
  for (int i = 0; i < 6; ++i) {
    const double yaw = wrap(i * kTwoPi / 6);
    scan.beams.push_back({{0.1 * std::cos(yaw), 0.1 * std::sin(yaw), yaw}, rng.uniform(0.2, 3.9), Echo::hit});
  }
  scan.beams[2] = {scan.beams[2].sensor_in_base, 0.0, Echo::none};
  return scan;
}

LandmarkDetections sighting(std::int64_t utime, const Pose2& pose, Rng& rng) {
  LandmarkDetections frame{{utime, 0}, {}, {}};
  for (int i = 0; i < 8; ++i) {
    const Vector2 seen = inverse(pose) * Vector2(4.0 * std::cos(0.8 * i), 4.0 * std::sin(0.8 * i));
    LandmarkDetection d;
    d.range = seen.norm() + rng.normal(0.0, 0.01);
    d.bearing = wrap(std::atan2(seen.y(), seen.x()) + rng.normal(0.0, 0.002));
    d.covariance << 1e-4, 1e-7, 1e-7, 4e-6;
    d.id = i;
    frame.detections.push_back(d);
  }
  return frame;
}

// A drive around a circle: landmarks at every stop, at every third a ring of ranges too.
std::vector<Observation> drive(bool with_ranges) {
  std::vector<Observation> run;
  Rng rng(1, stream_id("rawlog_test"));
  Pose2 pose;
  constexpr std::int64_t kStart = 1'700'000'000'123'456;
  for (int k = 0; k < 40; ++k) {
    const std::int64_t utime = kStart + 100'000 * k;
    if (k > 0) {
      const Pose2 step{0.1 + rng.normal(0.0, 1e-3), rng.normal(0.0, 1e-4), 0.05 + rng.normal(0.0, 2e-3)};
      pose = pose * step;
      run.emplace_back(odometry(utime, step));
    }
    run.emplace_back(sighting(utime, pose, rng));
    if (with_ranges && k % 3 == 0) run.emplace_back(ring(utime, rng));
  }
  run.emplace_back(odometry(kStart + 4'000'000, {0.1, 0.0, 0.05}));
  put_in_order(run);
  return run;
}

void write(const std::filesystem::path& path, const std::vector<Observation>& run) {
  RawlogWriter writer(path);
  for (const Observation& o : run) writer.write(o);
  writer.close();
}

void expect_equal(const Odometry& a, const Odometry& b) {
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_LT(difference(a.increment, b.increment).norm(), 1e-12);
  EXPECT_LT((a.covariance - b.covariance).norm(), 1e-15);
}

TEST(Rawlog, WhatIsWrittenIsReadBack) {
  const TemporaryFolder folder;
  const auto run = drive(true);
  write(folder.path() / "run.rawlog", run);
  RawlogSource source({.path = folder.path() / "run.rawlog"});
  EXPECT_TRUE(source.notes().empty());
  const auto back = all(source);

  const auto odometry_a = only<Odometry>(run), odometry_b = only<Odometry>(back);
  ASSERT_EQ(odometry_a.size(), odometry_b.size());
  for (std::size_t i = 0; i < odometry_a.size(); ++i) expect_equal(odometry_a[i], odometry_b[i]);

  const auto scans_a = only<UltrasonicScan>(run), scans_b = only<UltrasonicScan>(back);
  ASSERT_EQ(scans_a.size(), scans_b.size());
  for (std::size_t i = 0; i < scans_a.size(); ++i) {
    EXPECT_EQ(scans_a[i].stamp, scans_b[i].stamp);
    EXPECT_EQ(scans_a[i].half_angle, scans_b[i].half_angle);
    EXPECT_EQ(scans_a[i].min_range, scans_b[i].min_range);
    EXPECT_EQ(scans_a[i].max_range, scans_b[i].max_range);
    ASSERT_EQ(scans_a[i].beams.size(), scans_b[i].beams.size());
    for (std::size_t k = 0; k < scans_a[i].beams.size(); ++k) {
      const UltrasonicBeam &a = scans_a[i].beams[k], &b = scans_b[i].beams[k];
      EXPECT_EQ(a.echo, b.echo);
      EXPECT_NEAR(a.range, b.range, 1e-6);  // single precision
      EXPECT_LT(difference(a.sensor_in_base, b.sensor_in_base).norm(), 1e-12);
    }
  }

  const auto frames_a = only<LandmarkDetections>(run), frames_b = only<LandmarkDetections>(back);
  ASSERT_EQ(frames_a.size(), frames_b.size());
  for (std::size_t i = 0; i < frames_a.size(); ++i) {
    EXPECT_EQ(frames_a[i].stamp, frames_b[i].stamp);
    ASSERT_EQ(frames_a[i].detections.size(), frames_b[i].detections.size());
    for (std::size_t k = 0; k < frames_a[i].detections.size(); ++k) {
      const LandmarkDetection &a = frames_a[i].detections[k], &b = frames_b[i].detections[k];
      EXPECT_EQ(a.id, b.id);
      EXPECT_NEAR(a.range, b.range, 1e-6);
      EXPECT_NEAR(a.bearing, b.bearing, 1e-6);
      EXPECT_EQ(a.covariance, b.covariance);
    }
  }
}

TEST(Rawlog, OdometryBetweenTwoFramesAddsUp) {
  const TemporaryFolder folder;
  Rng rng(2);
  const Odometry a = odometry(1'100'000, {0.1, 0.01, 0.2}), b = odometry(1'200'000, {0.2, 0.0, -0.1});
  write(folder.path() / "run.rawlog", {ring(1'000'000, rng), a, GroundTruth{}, b, ring(1'200'000, rng)});
  RawlogSource source({.path = folder.path() / "run.rawlog"});
  const auto sum = PoseGaussian{a.increment, a.covariance} * PoseGaussian{b.increment, b.covariance};
  const auto back = only<Odometry>(all(source));
  ASSERT_EQ(back.size(), 1u);
  expect_equal(back[0], {{1'200'000, 0}, sum.mean, sum.covariance});
}

TEST(Rawlog, RefusesPlacesItCannotReadOrWrite) {
  const TemporaryFolder folder;
  const std::string absent = (folder.path() / "absent" / "run.rawlog").string();
  EXPECT_EQ(refusal([&] { RawlogWriter{absent}; }),
            absent + ": expected a file that can be written, got: cannot be created");
  EXPECT_EQ(refusal([&] { RawlogSource({.path = absent}); }),
            absent + ": expected a readable file, plain or gzip, got: No such file or directory");
}

TEST(Rawlog, ReadsWhatIsThereOfAFileThatWasCutOff) {
  const TemporaryFolder folder;
  const auto run = drive(true);
  write(folder.path() / "run.rawlog", run);
  std::ifstream in(folder.path() / "run.rawlog", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  RawlogSource source({.path = folder.write("cut.rawlog", bytes.substr(0, bytes.size() / 2))});
  ASSERT_EQ(source.notes().size(), 2u);
  EXPECT_NE(source.notes()[0].find("the compressed file is cut off"), std::string::npos);
  EXPECT_NE(source.notes()[1].find("cut off inside object"), std::string::npos);
  const auto back = only<Odometry>(all(source)), whole = only<Odometry>(run);
  ASSERT_GT(back.size(), 5u);
  ASSERT_LT(back.size(), whole.size());
  for (std::size_t i = 0; i < back.size(); ++i) expect_equal(whole[i], back[i]);
}

// ---- MRPT's own programs and data ----

// Output and exit code of a command; nothing where its program is not installed.
struct Outcome {
  std::string output;
  int code = 0;
};
std::optional<Outcome> run_program(const std::string& program, const std::string& arguments) {
  if (std::system(("command -v " + program + " > /dev/null").c_str()) != 0) return std::nullopt;
  FILE* pipe = popen((program + " " + arguments + " < /dev/null 2>&1").c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  Outcome outcome;
  std::array<char, 4096> block;
  while (const std::size_t n = fread(block.data(), 1, block.size(), pipe)) outcome.output.append(block.data(), n);
  outcome.code = pclose(pipe);
  return outcome;
}

TEST(RawlogPrograms, RawlogEditCountsWhatWasWritten) {
  const TemporaryFolder folder;
  write(folder.path() / "run.rawlog", drive(true));
  const auto outcome = run_program("rawlog-edit", "--info -i " + (folder.path() / "run.rawlog").string());
  if (!outcome) GTEST_SKIP() << "rawlog-edit (Debian package mrpt-apps) is not installed";
  EXPECT_EQ(outcome->code, 0);
  for (const char* expected :
       {"Overall number of objects         : 80\n", "Actions/SensoryFrame format       : Yes\n",
        "Earliest timestamp                : 1700000000.123456 ", "LANDMARKS /     40 ", "ULTRASONIC /     14 "}) {
    EXPECT_NE(outcome->output.find(expected), std::string::npos) << expected << "\n" << outcome->output;
  }
}

TEST(RawlogPrograms, KfSlamMapsTheLandmarksOfARun) {
  const TemporaryFolder folder;
  write(folder.path() / "run.rawlog", drive(false));
  folder.write("kf.ini", "[MappingApplication]\nkf_implementation=CRangeBearingKFSLAM2D\nlogOutput_dir=" +
                             (folder.path() / "log").string() +
                             "\nSAVE_LOG_FREQUENCY=39\nSHOW_3D_LIVE=false\nCAMERA_3DSCENE_FOLLOWS_ROBOT=false\n"
                             "[RangeBearingKFSLAM_KalmanFilter]\nmethod=0\nverbose=false\n[RangeBearingKFSLAM]\n"
                             "std_sensor_range=0.01\nstd_sensor_yaw_deg=0.12\nstd_sensor_pitch_deg=0.1\n");
  const auto outcome =
      run_program("kf-slam", (folder.path() / "kf.ini").string() + " " + (folder.path() / "run.rawlog").string());
  if (!outcome) GTEST_SKIP() << "kf-slam (Debian package mrpt-apps) is not installed";
  ASSERT_EQ(outcome->code, 0) << outcome->output;
  std::ifstream in(folder.path() / "log" / "robot_pose_00039.txt");
  Pose2 estimate;
  ASSERT_TRUE(in >> estimate.x >> estimate.y >> estimate.yaw);
  Pose2 pose;
  const auto odometry = only<Odometry>(drive(false));
  for (std::size_t i = 0; i < 39; ++i) pose = pose * odometry[i].increment;
  EXPECT_LT(difference(estimate, pose).norm(), 0.05);
}

// Debian's mrpt-common ships a few rawlogs.
#define NOCTULE_MRPT_DATA(path, name)                                                            \
  const std::filesystem::path path = std::filesystem::path("/usr/share/mrpt/datasets") / (name); \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "Debian package mrpt-common is not installed"

TEST(RawlogOfMrpt, TheSenaLoopIsALaserRunThatMakesAVirtualRing) {
  NOCTULE_MRPT_DATA(path, "2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog");
  RawlogSource source({.path = path, .ring = {.sensors = 8, .max_range = 4.0}});
  EXPECT_NE(source.world().name.find("virtual ultrasonic ring"), std::string::npos);
  const auto observations = all(source);
  const auto scans = only<UltrasonicScan>(observations);
  EXPECT_EQ(scans.size(), 225u);
  EXPECT_EQ(only<Odometry>(observations).size(), 224u);
  EXPECT_NEAR(seconds(scans.back().stamp.utime - scans.front().stamp.utime), 59.07, 0.01);
  double length = 0.0;
  for (const Odometry& o : only<Odometry>(observations)) length += o.increment.position().norm();
  EXPECT_NEAR(length, 76.35, 0.1);
  for (const UltrasonicScan& s : scans) {
    ASSERT_EQ(s.beams.size(), 8u);
    for (const UltrasonicBeam& b : s.beams) EXPECT_NEAR(b.sensor_in_base.x, 0.78, 1e-6);
  }
}

TEST(RawlogOfMrpt, TheKfSlamDemoHasSightingsAndUselessTimes) {
  NOCTULE_MRPT_DATA(path, "kf-slam_demo.rawlog");
  EXPECT_NE(refusal([&] { RawlogSource({.path = path}); }).find("frame_period_s"), std::string::npos);
  RawlogSource source({.path = path, .frame_period = 0.1});
  const auto observations = all(source);
  const auto frames = only<LandmarkDetections>(observations);
  ASSERT_EQ(frames.size(), 250u);
  EXPECT_EQ(frames[0].detections.size(), 27u);
  EXPECT_NEAR(frames[0].detections[0].range, 3.354, 1e-3);
  EXPECT_NEAR(frames[0].detections[0].covariance(0, 0), 1e-4, 1e-9);
}

}  // namespace
}  // namespace noctule::datasets
