#include "sim/landmark_world.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>

#include "config/config.hpp"
#include "core/error.hpp"
#include "core/limits.hpp"
#include "core/observation_checks.hpp"
#include "core/observation_order.hpp"
#include "sim/landmark_map.hpp"

namespace noctule::sim {
namespace {

namespace fs = std::filesystem;

/// A square of 40 m with a landmark beyond each corner.
LandmarkWorldParameters square() {
  LandmarkWorldParameters p;
  p.world.name = "square";
  p.world.waypoints = {{40, 0}, {40, 40}, {0, 40}, {0, 0}};
  p.world.landmarks = {{50, -10}, {50, 50}, {-10, 50}, {-10, -10}, {20, 20}};
  return p;
}

struct LandmarkRecording {
  std::vector<Observation> all;
  std::vector<Odometry> odometry;
  std::vector<GroundTruth> truth;
  std::vector<LandmarkDetections> scans, informed;
  KnownWorld world;

  LandmarkRecording(const LandmarkWorldParameters& p, std::uint64_t seed) {
    LandmarkWorld source(p, seed);
    world = source.world();
    while (auto o = source.next()) {
      all.push_back(*o);
      if (const auto* x = std::get_if<Odometry>(&*o)) odometry.push_back(*x);
      if (const auto* x = std::get_if<GroundTruth>(&*o)) truth.push_back(*x);
      if (const auto* x = std::get_if<LandmarkDetections>(&*o)) {
        scans.push_back(*x);
        informed.push_back(source.informed());
      }
    }
  }
};

std::string refusal(const std::function<void()>& body) {
  try {
    body();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}
std::string refusal(const std::function<void(LandmarkWorldParameters&)>& change) {
  LandmarkWorldParameters p = square();
  change(p);
  return refusal([&] { LandmarkWorld(p, 1); });
}
void expect_says(const std::string& message, const std::string& what) {
  EXPECT_NE(message.find(what), std::string::npos) << "wanted: " << what << "\ngot: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(LandmarkWorld, StreamIsInOrderCountsWithoutGapsAndPassesTheFiltersDoor) {
  const LandmarkRecording r(square(), 1);
  std::array<std::int64_t, 4> count{};
  for (std::size_t i = 0; i < r.all.size(); ++i) {
    if (i > 0) {
      EXPECT_GE(stamp_of(r.all[i]).utime, stamp_of(r.all[i - 1]).utime);
    }
    EXPECT_EQ(stamp_of(r.all[i]).seq, count[r.all[i].index()]++);
  }
  EXPECT_EQ(r.scans.size(), r.odometry.size() / 8);
  EXPECT_EQ(r.truth.size(), r.scans.size());
  for (std::size_t i = 0; i < r.scans.size(); ++i) {
    EXPECT_EQ(r.scans[i].stamp.utime, r.truth[i].stamp.utime);
    EXPECT_EQ(r.scans[i].stamp.utime, 200'000 * (static_cast<std::int64_t>(i) + 1));
    EXPECT_NO_THROW(check(r.scans[i]));
  }
  for (const Odometry& o : r.odometry) EXPECT_NO_THROW(check(o));
  EXPECT_LT((r.truth.back().base_in_map.position() - Vector2(0, 0)).norm(), 2.0);
}

TEST(LandmarkWorld, TruthDoesNotDependOnTheSeedAndMeasurementsDo) {
  const LandmarkRecording a(square(), 1), b(square(), 2), again(square(), 1);
  ASSERT_EQ(a.truth.size(), b.truth.size());
  for (std::size_t i = 0; i < a.truth.size(); ++i) EXPECT_EQ(a.truth[i].base_in_map, b.truth[i].base_in_map);
  EXPECT_FALSE(a.odometry[0].increment == b.odometry[0].increment);
  for (std::size_t i = 0; i < a.odometry.size(); ++i) {
    EXPECT_EQ(a.odometry[i].increment, again.odometry[i].increment);
    EXPECT_EQ(a.odometry[i].covariance, again.odometry[i].covariance);
  }
}

TEST(LandmarkWorld, DeadReckoningWithoutNoiseIsTheTruth) {
  LandmarkWorldParameters p = square();
  p.vehicle.speed_sd = p.vehicle.steering_sd = 0.0;
  p.world.start = {1.0, -2.0, 0.3};
  p.world.loops = 5;
  const LandmarkRecording r(p, 1);
  Pose2 pose = r.world.start_in_map;
  std::size_t scan = 0;
  for (const Odometry& o : r.odometry) {
    pose = pose * o.increment;
    EXPECT_EQ(o.covariance, Matrix3::Zero());
    if (scan == r.truth.size() || r.truth[scan].stamp.utime != o.stamp.utime) continue;
    EXPECT_LT(difference(pose, r.truth[scan++].base_in_map).norm(), 1e-12);
  }
  EXPECT_EQ(scan, r.truth.size());
}

TEST(LandmarkWorld, TruthFollowsTheModelOfTheFrontAxle) {
  const LandmarkWorldParameters p = square();
  const std::vector<ControlStep> steps = plan_steps({}, p.world.waypoints, 1, p.vehicle);
  Pose2 pose;
  double steering = 0.0;
  for (const ControlStep& s : steps) {
    EXPECT_LE(std::abs(s.steering), p.vehicle.max_steering);
    EXPECT_LE(std::abs(s.steering - steering), p.vehicle.steering_rate / 40.0 + 1e-12);
    steering = s.steering;
    pose = {pose.x + 3.0 / 40.0 * std::cos(pose.yaw + steering), pose.y + 3.0 / 40.0 * std::sin(pose.yaw + steering),
            wrap(pose.yaw + 3.0 / 40.0 * std::sin(steering) / 4.0)};
    EXPECT_LT(difference(pose, s.pose).norm(), 1e-11);
  }
}

TEST(LandmarkWorld, VisibleSetEqualsBruteForce) {
  Rng rng(7);
  int visible = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Pose2 pose{rng.uniform(-50, 50), rng.uniform(-50, 50), rng.uniform(-kPi, kPi)};
    const Vector2 place(rng.uniform(-50, 50), rng.uniform(-50, 50));
    const Vector2 local = inverse(pose) * place;
    const bool near = std::hypot(local.x(), local.y()) < 30.0;
    const bool ahead = std::abs(std::atan2(local.y(), local.x())) < kPi / 2;
    EXPECT_EQ(sees(pose, place, 30.0), near && ahead);
    visible += near && ahead;
  }
  EXPECT_GT(visible, 500);
}

TEST(LandmarkWorld, SeesExactlyWhatIsAhead) {
  const LandmarkRecording r(square(), 3);
  for (std::size_t i = 0; i < r.scans.size(); ++i) {
    std::vector<std::int64_t> expected, got;
    for (const KnownLandmark& l : r.world.landmarks) {
      if (sees(r.truth[i].base_in_map, l.position, 30.0)) expected.push_back(l.id);
    }
    for (const LandmarkDetection& d : r.scans[i].detections) got.push_back(d.id);
    EXPECT_EQ(got, expected);
  }
}

TEST(LandmarkWorld, SchedulesOutliersAndLabelsScaleTheSameDraws) {
  LandmarkWorldParameters p = square();
  const LandmarkRecording plain(p, 4);
  p.sensor.schedule = {{0.5, 3.0}};
  p.sensor.known_ids = false;
  const LandmarkRecording staged(p, 4);
  ASSERT_EQ(plain.scans.size(), staged.scans.size());
  for (std::size_t i = 0; i < plain.scans.size(); ++i) {
    const double progress = 8.0 * static_cast<double>(i + 1) / static_cast<double>(plain.odometry.size());
    const double factor = progress >= 0.5 ? 3.0 : 1.0;
    ASSERT_EQ(plain.scans[i].detections.size(), staged.scans[i].detections.size());
    for (std::size_t k = 0; k < plain.scans[i].detections.size(); ++k) {
      const LandmarkDetection &a = plain.scans[i].detections[k], &b = staged.scans[i].detections[k];
      const Vector2 place = plain.world.landmarks[static_cast<std::size_t>(a.id)].position;
      const double range = (place - plain.truth[i].base_in_map.position()).norm();
      EXPECT_NEAR(b.range - range, factor * (a.range - range), 1e-9);
      EXPECT_EQ(b.id, -1);
      EXPECT_NEAR(std::sqrt(b.covariance(1, 1)), radians(1), 1e-12);
      const LandmarkDetection& informed = staged.informed[i].detections[k];
      EXPECT_EQ(informed.id, a.id);
      EXPECT_EQ(informed.range, b.range);
      EXPECT_EQ(informed.bearing, b.bearing);
      EXPECT_NEAR(std::sqrt(informed.covariance(0, 0)), factor * 0.1, 1e-12);
    }
  }
}

TEST(LandmarkWorld, ClutterLiesAheadAndLeavesTheOtherStreamsAlone) {
  LandmarkWorldParameters p = square();
  const LandmarkRecording plain(p, 5);
  p.sensor.clutter = 2.0;
  const LandmarkRecording cluttered(p, 5);
  double count = 0.0;
  for (std::size_t i = 0; i < plain.scans.size(); ++i) {
    const auto &a = plain.scans[i].detections, &b = cluttered.scans[i].detections;
    ASSERT_GE(b.size(), a.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].range, b[k].range);
    for (std::size_t k = a.size(); k < b.size(); ++k) {
      EXPECT_EQ(b[k].id, -1);
      EXPECT_LE(std::abs(b[k].bearing), kPi / 2);
      EXPECT_EQ(cluttered.informed[i].detections.size(), a.size());
      ++count;
    }
  }
  const double scans = static_cast<double>(plain.scans.size());
  EXPECT_NEAR(count / scans, 2.0, 4.0 * std::sqrt(2.0 / scans));
}

TEST(LandmarkWorld, StrongNoiseYieldsNoRangeThatIsNotPositive) {
  LandmarkWorldParameters p = square();
  p.sensor.range_sd = 20.0;
  const LandmarkRecording r(p, 6);
  for (const LandmarkDetections& scan : r.scans) EXPECT_NO_THROW(check(scan));
}

TEST(LandmarkWorld, RefusesAWaypointThatItWouldCircleForEver) {
  expect_says(refusal([](LandmarkWorldParameters& p) { p.world.scale = 0.1; }),
              "vehicle: expected steering that reaches way-point (4, 4) m, got circles past it (turning radius 8 m");
  LandmarkWorldParameters p = square();
  p.world.scale = 0.1;
  p.vehicle.speed = 0.3;
  p.vehicle.wheelbase = 0.2;
  p.vehicle.waypoint_radius = 0.2;
  EXPECT_NO_THROW(LandmarkWorld(p, 1));
  p.vehicle.max_steering = 1e-9;
  expect_says(refusal([&] { LandmarkWorld(p, 1); }), "got circles past it");
}

TEST(LandmarkWorld, RefusesWhatMakesNoWorld) {
  using P = LandmarkWorldParameters;
  expect_says(refusal([](P& p) { p.world.waypoints.clear(); }), "got no way-point");
  expect_says(refusal([](P& p) { p.world.landmarks.clear(); }), "got no landmark");
  expect_says(refusal([](P& p) { p.world.waypoints = {{1.2, 0}}; }), "expected a way of at least 8 controls");
  expect_says(refusal([](P& p) { p.sensor.range_sd = 0.0; }), "sensor.range_sd_m: expected a finite number > 0");
  expect_says(refusal([](P& p) { p.world.scale = -1.0; }), "world.scale: expected a finite number > 0");
  expect_says(refusal([](P& p) { p.vehicle.speed_sd = kNan; }), "vehicle.speed_sd_m_per_s");
  expect_says(refusal([](P& p) { p.sensor.schedule = {{0.5, 2.0}, {0.2, 1.0}}; }), "stage 2 of the noise schedule");
  expect_says(refusal([](P& p) {
                p.world.scatter = ScatterParameters{3, 1, {0, 0}, {0, 1}};
              }),
              "low_m: expected both coordinates below");
}

class LandmarkFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::temp_directory_path() / ("noctule_landmarks_" + std::to_string(::getpid()) + ".mat");
  }
  void TearDown() override { fs::remove(path_); }
  std::string refusal_of(const std::string& text, const std::string& block = "lm") {
    write(text);
    const std::string message = refusal([&] { static_cast<void>(read_places(path_, block)); });
    return message.substr(message.find(path_.filename().string()) + path_.filename().string().size());
  }
  void write(const std::string& text) { std::ofstream(path_) << text; }
  fs::path path_;
};

TEST_F(LandmarkFile, ReadsBothBlocks) {
  write("#type columns rows\nlm 2 2\n1.5 -2\n\n3 4 # a comment\nwp 2 1\n 7e1\t8\n");
  EXPECT_EQ(read_places(path_, "lm"), (std::vector<Vector2>{{1.5, -2}, {3, 4}}));
  EXPECT_EQ(read_places(path_, "wp"), (std::vector<Vector2>{{70, 8}}));
  LandmarkWorldParameters p = square();
  p.world.landmark_file = path_;
  p.world.scale = 2.0;
  const auto landmarks = places_of(p.world).landmarks;
  ASSERT_EQ(landmarks.size(), 7u);
  EXPECT_EQ(landmarks[6].id, 6);
  EXPECT_EQ(landmarks[6].position, Vector2(6, 8));
  p.world.waypoint_file = path_;
  expect_says(refusal([&] { LandmarkWorld(p, 1); }), "world.waypoints_m: expected none beside a waypoint_file, got 4");
}

TEST_F(LandmarkFile, NamesTheLineThatIsWrong) {
  EXPECT_EQ(refusal_of("lm 2 2\n1 2\n3\n"), ":3: expected 2 rows 'x y' of the block lm, got '3'");
  EXPECT_EQ(refusal_of("lm 2 2\n1 2\n3 nan\n"), ":3: expected 2 rows 'x y' of the block lm, got '3 nan'");
  EXPECT_EQ(refusal_of("lm 2 2\n1 2\n"), ":2: expected 2 rows 'x y' of the block lm, got the end of the file");
  EXPECT_EQ(refusal_of("lm 3 2\n"), ":1: expected a line 'lm 2 ROWS', got 'lm 3 2'");
  EXPECT_EQ(refusal_of("lm 2 1\n1 2\n", "wp"), ":2: expected a line 'wp 2 ROWS', got the end of the file");
  expect_says(refusal([] { static_cast<void>(read_places("/nowhere/map.mat", "lm")); }),
              "/nowhere/map.mat: expected a readable map file, got: No such file");
  expect_says(refusal([] { static_cast<void>(read_places("/tmp", "lm")); }),
              "/tmp: expected a readable map file, got: a folder");
}

TEST(BaileysMap, OneLapTakes8778ControlsAnd1097Scans) {
  const char* shared = std::getenv("NOCTULE_SHARED");
  const fs::path file = (shared != nullptr ? fs::path(shared) : fs::path(NOCTULE_SOURCE_DIR) / ".." / "shared") /
                        "data/bailey-maps/example_webmap.mat";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
  LandmarkWorldParameters p;
  p.world.landmark_file = p.world.waypoint_file = file;
  const LandmarkRecording r(p, 1);
  EXPECT_EQ(r.world.landmarks.size(), 35u);
  EXPECT_EQ(r.odometry.size(), 8778u);
  EXPECT_EQ(r.scans.size(), 1097u);
  // The trap: at this scale the vehicle circles the first way-points for ever, unless it is smaller too.
  p.world.scale = 0.35;
  LandmarkWorldParameters small = p;
  small.vehicle.speed = small.vehicle.wheelbase = 1.0;
  EXPECT_NO_THROW(LandmarkWorld(small, 1));
  expect_says(refusal([&] { LandmarkWorld(p, 1); }), "vehicle: expected steering that reaches way-point");
}

/// Whatever sightings measure: the same numbers, and whoever knows the simulator sees both.
TEST(LandmarkWorldTest, SightingsOfOneNumberAreThoseOfTwoWithoutTheOther) {
  LandmarkWorldParameters p;
  p.world.waypoints = {{30, 0}};
  p.world.landmarks = {{10, 5}, {20, -5}, {40, 8}};
  p.sensor.clutter = 0.5;
  const LandmarkRecording whole(p, 3);
  p.sensor.whole = 0.25;
  for (const auto kind : {DetectionKind::bearing_only, DetectionKind::range_only}) {
    p.sensor.kind = kind;
    const LandmarkRecording part(p, 3);
    ASSERT_EQ(part.scans.size(), whole.scans.size());
    int one = 0, two = 0;
    for (std::size_t i = 0; i < whole.scans.size(); ++i) {
      ASSERT_EQ(part.scans[i].detections.size(), whole.scans[i].detections.size());
      for (std::size_t k = 0; k < part.scans[i].detections.size(); ++k) {
        const LandmarkDetection &a = part.scans[i].detections[k], &b = whole.scans[i].detections[k];
        const bool both = a.kind == DetectionKind::range_bearing;
        (both ? two : one) += 1;
        EXPECT_EQ(a.id, b.id);
        EXPECT_EQ(a.range, both || kind == DetectionKind::range_only ? b.range : 0.0);
        EXPECT_EQ(a.bearing, both || kind == DetectionKind::bearing_only ? b.bearing : 0.0);
        EXPECT_EQ(a.covariance(0, 0) > 0.0, both || kind == DetectionKind::range_only);
      }
      ASSERT_EQ(part.informed[i].detections.size(), whole.informed[i].detections.size());
      for (const LandmarkDetection& d : part.informed[i].detections) EXPECT_EQ(d.kind, DetectionKind::range_bearing);
    }
    EXPECT_NEAR(two / static_cast<double>(one + two), 0.25, 4.0 * std::sqrt(0.25 * 0.75 / (one + two)));
  }
}

}  // namespace
}  // namespace noctule::sim
