#include <gtest/gtest.h>

#include <map>

#include "statistics/sensors/scene.hpp"

namespace noctule::sensors {
namespace {

using scene::Kind;

/// Two objects on both sides of a drive with turns; odometry with its covariance.
std::vector<MovedScan> two_objects(std::uint64_t seed) {
  Rng rng(seed);
  const scene::Object left = scene::place(Kind::wall, 1.0, radians(20.0), rng);
  scene::Object right = scene::place(Kind::cylinder, 0.7, 0.0, rng);
  right.cylinder.centre.y() *= -1.0;
  const models::OdometryNoise noise;
  std::vector<MovedScan> scans;
  Pose2 base{-0.5, 0.0, 0.0};
  for (int k = 0; k < 10; ++k) {
    const Pose2 step{k == 0 ? 0.0 : 0.12, 0.0, k % 3 == 1 ? 0.2 : -0.1};
    base = base * step;
    UltrasonicScan scan = scene::scan(left, base, {}, k, rng);
    const UltrasonicScan other = scene::scan(right, base, {}, k, rng);
    for (std::size_t i = 0; i < scan.beams.size(); ++i)
      if (scan.beams[i].echo != Echo::hit) scan.beams[i] = other.beams[i];
    scans.push_back({{step, noise.straight(step.x) + noise.turn_on_the_spot()}, scan});
  }
  return scans;
}

void expect_same(const ContourFeature& a, const ContourFeature& b, double tolerance) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.track, b.track);
  EXPECT_EQ(a.stops, b.stops);
  EXPECT_EQ(a.readings, b.readings);
  EXPECT_NEAR(a.baseline, b.baseline, tolerance);
  ASSERT_EQ(a.has_wall, b.has_wall);
  ASSERT_EQ(a.has_circle, b.has_circle);
  EXPECT_NEAR(a.wall.rho, b.wall.rho, tolerance);
  EXPECT_NEAR(wrap(a.wall.theta - b.wall.theta), 0.0, tolerance);
  EXPECT_LE((a.wall_covariance - b.wall_covariance).norm(), tolerance);
  EXPECT_NEAR(a.wall_log_likelihood, b.wall_log_likelihood, 1e3 * tolerance);
  EXPECT_LE((a.circle.centre - b.circle.centre).norm(), tolerance);
  EXPECT_NEAR(a.circle.radius, b.circle.radius, tolerance);
  EXPECT_LE((a.circle_covariance - b.circle_covariance).norm(), tolerance);
  EXPECT_NEAR(a.circle_log_likelihood, b.circle_log_likelihood, 1e3 * tolerance);
}

/// The base is only a frame: choosing another point and heading of the robot as base moves every feature rigidly.
TEST(ExtractorInvariance, UnderTheChoiceOfTheBaseFrame) {
  const Pose2 old_T_new{0.15, -0.08, 1.1};
  const Pose2 new_T_old = inverse(old_T_new);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto scans = two_objects(seed);
    auto moved = scans;
    for (MovedScan& m : moved) {
      const Matrix3 j = compose_jacobian_right(new_T_old) * compose_jacobian_left(m.motion.mean, old_T_new);
      m.motion = {new_T_old * m.motion.mean * old_T_new, j * m.motion.covariance * j.transpose()};
      for (auto& beam : m.scan.beams) beam.sensor_in_base = new_T_old * beam.sensor_in_base;
    }
    const auto expected = extract(scans, {});
    auto features = extract(moved, {});
    ASSERT_EQ(features.size(), expected.size());
    const FrameChange back({new_T_old, Matrix3::Zero()});
    for (std::size_t i = 0; i < features.size(); ++i) {
      back.apply(features[i]);
      expect_same(features[i], expected[i], 1e-6);
    }
  }
}

TEST(ExtractorInvariance, BatchIsStreaming) {
  const auto scans = two_objects(11);
  UltrasonicExtractor extractor({});
  std::map<std::int64_t, ContourFeature> latest;
  std::int64_t seq = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (k > 0) {
      // Two halves of the motion instead of one whole: the first carries all of the covariance.
      extractor.predict({{2 * seq, 2 * seq}, scans[k].motion.mean, scans[k].motion.covariance});
      extractor.predict({{2 * seq + 1, 2 * seq + 1}, {}, Matrix3::Zero()});
      ++seq;
      for (auto& [track, feature] : latest) FrameChange(scans[k].motion).apply(feature);
    }
    for (const auto& f : extractor.update(scans[k].scan).features) latest[f.track] = f;
  }
  const auto batch = extract(scans, {});
  ASSERT_EQ(batch.size(), latest.size());
  for (const ContourFeature& f : batch) expect_same(f, latest.at(f.track), 1e-9);
}

TEST(ExtractorInvariance, TheOrderOfTheBeamsDoesNotMatter) {
  const auto scans = two_objects(12);
  auto reversed = scans;
  for (MovedScan& m : reversed) std::reverse(m.scan.beams.begin(), m.scan.beams.end());
  const auto a = extract(scans, {}), b = extract(reversed, {});
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].type, b[i].type);
    EXPECT_NEAR(a[i].wall.rho, b[i].wall.rho, 1e-9);
    EXPECT_LE((a[i].circle.centre - b[i].circle.centre).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace noctule::sensors
