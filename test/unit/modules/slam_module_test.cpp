/// The filter sees everything in the order of the source, however the messages of two processes interleave.
#include "modules/slam_module.hpp"

#include <gtest/gtest.h>

#include "heard.hpp"
#include "noctule/contour_features.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/odometry.hpp"
#include "noctule/slam_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::modules {
namespace {

constexpr std::int64_t kPeriod = 100'000;

Odometry motion(std::int64_t seq) {
  Odometry o;
  o.stamp = {(seq + 1) * kPeriod, seq};
  o.increment = {0.1, 0.0, 0.02};
  o.covariance = Vector3(1e-4, 1e-4, 1e-4).asDiagonal();
  return o;
}

/// A wall 2 m ahead of the start, heard head on.
UltrasonicScan scan(std::int64_t seq) {
  UltrasonicScan s;
  s.stamp = {(seq + 1) * kPeriod, seq};
  s.half_angle = radians(15.0);
  s.min_range = 0.02;
  s.max_range = 4.0;
  s.beams.push_back({{}, 2.0 - 0.1 * static_cast<double>(seq + 1), Echo::hit});
  return s;
}

ContourFeatures features(std::int64_t seq) {
  ContourFeature wall;
  wall.type = ContourType::wall;
  wall.track = 0;
  wall.has_wall = true;
  wall.wall = {scan(seq).beams[0].range, 0.0};
  wall.wall_covariance = Vector2(1e-4, 1e-2).asDiagonal();
  wall.surface = {wall.wall.rho, 0.0};
  wall.stops = 3;
  wall.baseline = 0.2;
  wall.readings = {{seq, 0}};
  return {scan(seq).stamp, {wall}};
}

class SlamModuleTest : public ::testing::Test {
 protected:
  SlamModuleTest() {
    SlamModuleParameters parameters;
    std::get<filters::ParticleSlamParameters>(parameters.filter).particles = 20;
    module_ = std::make_unique<SlamModule>(bus_, parameters, SlamInput{}, 1, Pose2{});
  }
  void o(std::int64_t seq) { send("ODOMETRY", convert::to_message(motion(seq))); }
  void s(std::int64_t seq) { send("ULTRASONIC_SCAN", convert::to_message(scan(seq))); }
  void f(std::int64_t seq) { send("CONTOUR_FEATURES", convert::to_message(features(seq))); }
  std::int64_t dropped() {
    module_->finish();
    bus_.drain();
    return statuses_.all.back().dropped;
  }
  /// x of the poses, to the bit.
  std::vector<double> xs() const {
    std::vector<double> all;
    for (const auto& estimate : estimates_.all) all.push_back(estimate.x_m);
    return all;
  }

  bus::Bus bus_;
  Heard<slam_estimate> estimates_{bus_, "SLAM_ESTIMATE"};
  Heard<module_status> statuses_{bus_, "MODULE_STATUS"};
  std::unique_ptr<SlamModule> module_;

 private:
  template <class M>
  void send(const std::string& channel, const M& message) {
    bus_.publish(channel, message);
    bus_.drain();
  }
};

/// Estimates when everything comes in order.
std::vector<double> in_order() {
  class InOrder : public SlamModuleTest {
   public:
    void TestBody() override {}
    std::vector<double> run() {
      for (const std::int64_t k : {0, 1, 2, 3}) o(k), s(k), f(k);
      EXPECT_EQ(dropped(), 0);
      return xs();
    }
  };
  return InOrder().run();
}

TEST_F(SlamModuleTest, AScanWaitsForItsFeatures) {
  o(0), s(0);
  EXPECT_TRUE(estimates_.all.empty());
  f(0);
  ASSERT_EQ(estimates_.all.size(), 1u);
  EXPECT_EQ(estimates_.all[0].utime, scan(0).stamp.utime);
  EXPECT_EQ(estimates_.all[0].seq, 0);
}

TEST_F(SlamModuleTest, WhatComesMeanwhileWaitsBehindTheScan) {
  o(0), s(0), o(1), f(0), s(1), o(2), f(1), s(2), f(2), o(3), s(3), f(3);
  EXPECT_EQ(dropped(), 0);
  EXPECT_EQ(xs(), in_order());
}

TEST_F(SlamModuleTest, FeaturesMayOvertakeTheirScan) {
  for (const std::int64_t k : {0, 1, 2, 3}) o(k), f(k), s(k);
  EXPECT_EQ(dropped(), 0);
  EXPECT_EQ(xs(), in_order());
}

TEST_F(SlamModuleTest, LostFeaturesAreNotWaitedForForEver) {
  o(0), s(0), o(1), s(1);
  ASSERT_EQ(estimates_.all.size(), 1u) << "the first scan, without features";
  f(1);
  EXPECT_EQ(estimates_.all.size(), 2u);
  EXPECT_EQ(dropped(), 1);
}

TEST_F(SlamModuleTest, LateFeaturesAreCountedAndUnused) {
  o(0), s(0), o(1), s(1), f(0);
  EXPECT_EQ(estimates_.all.size(), 1u);
  f(1);
  EXPECT_EQ(estimates_.all.size(), 2u);
  EXPECT_EQ(dropped(), 2) << "a scan without features, features without a scan";
}

TEST_F(SlamModuleTest, TheLastScanIsNotForgotten) {
  o(0), s(0);
  EXPECT_EQ(dropped(), 1);
  EXPECT_EQ(estimates_.all.size(), 1u);
}

/// Odometry and sightings of one landmark, as two processes send them: the sightings of a time come when the base has
/// moved on by so many steps.
std::pair<std::vector<double>, std::int64_t> sighted(double lag, std::int64_t late) {
  bus::Bus bus;
  Heard<slam_estimate> estimates(bus, "SLAM_ESTIMATE");
  Heard<module_status> statuses(bus, "MODULE_STATUS");
  SlamModuleParameters parameters;
  std::get<filters::ParticleSlamParameters>(parameters.filter).particles = 20;
  parameters.lag = lag;
  SlamModule module(bus, parameters, SlamInput{.features = false, .camera = true}, 1, Pose2{});
  constexpr std::int64_t kSteps = 20;
  for (std::int64_t k = 0; k < kSteps + late; ++k) {
    const std::int64_t seen = k - late;
    if (k < kSteps) {
      bus.publish("ODOMETRY",
                  convert::to_message(Odometry{{kPeriod * k, k}, {0.02, 0.0, 0.0}, 1e-6 * Matrix3::Identity()}));
      bus.drain();
    }
    if (seen < 0) continue;
    LandmarkDetection d{.range = 2.0 - 0.02 * static_cast<double>(seen + 1),
                        .bearing = 0.0,
                        .covariance = Matrix2::Identity() * 1e-4,
                        .id = 3};
    bus.publish("LANDMARK_DETECTIONS", convert::to_message(LandmarkDetections{{kPeriod * seen, seen}, {}, {d}}));
    bus.drain();
  }
  module.finish();
  bus.drain();
  std::vector<double> xs;
  for (const auto& estimate : estimates.all) xs.push_back(estimate.x_m);
  return {xs, statuses.all.back().dropped};
}

TEST(SlamModule, LateSightingsAreWaitedForAsLongAsAsked) {
  const auto [in_time, none] = sighted(0.0, 0);
  EXPECT_EQ(in_time.size(), 20u);
  EXPECT_EQ(none, 0);
  EXPECT_EQ(sighted(0.25, 2), std::pair(in_time, std::int64_t{0})) << "to the bit";
  const auto [late, dropped] = sighted(0.0, 2);
  EXPECT_EQ(dropped, 19) << "all but the last, after which the base stands still";
  EXPECT_EQ(late.size() + static_cast<std::size_t>(dropped), 20u);
}

TEST(SlamModule, LearnedNoiseDoesNotHideInnovationsFarAboveTheConfiguredNoise) {
  for (const double error : {0.0, 0.06}) {
    bus::Bus bus;
    Heard<module_status> statuses(bus, "MODULE_STATUS");
    SlamModuleParameters parameters;
    filters::VbParticleSlamParameters filter;
    filter.particles = 20;
    parameters.filter = filter;
    SlamModule module(bus, parameters, SlamInput{}, 1, Pose2{});
    for (std::int64_t i = 0; i < 16; ++i) {
      auto heard = scan(i);
      heard.beams[0].range += i % 2 == 0 ? error : -error;
      bus.publish("ODOMETRY", convert::to_message(motion(i)));
      bus.publish("ULTRASONIC_SCAN", convert::to_message(heard));
      bus.publish("CONTOUR_FEATURES", convert::to_message(features(i)));
    }
    bus.drain();
    module.finish();
    bus.drain();
    EXPECT_EQ(statuses.all.back().warning.find("innovations") != std::string::npos, error > 0.0) << error;
  }
}

}  // namespace
}  // namespace noctule::modules
