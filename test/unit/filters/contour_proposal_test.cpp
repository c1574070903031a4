#include <gtest/gtest.h>

#include <cmath>

#include "filters/slam/contour_observation.hpp"
#include "unit/filters/scene.hpp"

namespace noctule::filters {
namespace {

using test::corner_scene;

/// A map that was heard from near the origin, and the scan that follows a motion.
struct Situation {
  ParticleSlamParameters parameters;
  std::vector<ContourLandmark> map;
  UltrasonicScan scan;
  ContourFeatures none;
  PoseGaussian motion{{0.3, 0.0, 0.1}, Vector3(0.03, 0.02, radians(3.0)).cwiseAbs2().asDiagonal()};

  Situation() {
    const test::Scene scene = corner_scene();
    test::Ranger ranger;
    ranger.noise = {.base = 0.01, .relative = 0.0};
    parameters.echo.range_noise = ranger.noise;
    Rng rng(3, stream_id("contour_proposal_test"), 0);
    for (int k = 0; k < 6; ++k) {
      const Pose2 base{0.02 * k, -0.03 * k, 0.0};
      const test::Heard heard = test::listen(scene, base, k, ranger, rng);
      ContourFeatures features{heard.scan.stamp, {}};
      for (std::size_t object = 0; k == 0 && object < scene.objects(); ++object) {
        ContourFeature f;
        f.type = object < scene.walls.size() ? ContourType::wall : ContourType::arc;
        const auto [range, direction] = scene.echo(object, base.position());
        f.surface << range * std::cos(direction), range * std::sin(direction);
        for (const std::int32_t beam : heard.beams_of[object]) f.readings.push_back({heard.scan.stamp.seq, beam});
        features.features.push_back(f);
      }
      std::vector<char> scratch;
      ContourObservation(heard.scan, features, k, -2, parameters).apply(base, map, scratch);
    }
    const Pose2 truth = motion.mean * Pose2{0.03, -0.015, radians(2.0)};
    scan = test::listen(scene, truth, 6, ranger, rng).scan;
  }
};

struct Estimate {
  double evidence = 0.0, evidence_sd = 0.0, effective_share = 0.0;
  Vector3 mean = Vector3::Zero();
};

/// By importance sampling, with weights relative to e^offset.
template <class Draw>
Estimate estimate(const Situation& s, const ContourObservation& observation, double offset, const Draw& draw) {
  constexpr int kDraws = 4000;
  Estimate e;
  double squares = 0.0;
  std::vector<char> scratch;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const DrawnPose drawn = draw(Rng(5, stream_id("contour_proposal_test.draw"), 0, i));
    std::vector<ContourLandmark> map = s.map;
    const double weight =
        std::exp(observation.apply(drawn.pose, map, scratch).log_likelihood + drawn.log_correction - offset);
    e.evidence += weight;
    squares += weight * weight;
    e.mean += weight * drawn.pose.vector();
  }
  e.mean /= e.evidence;
  e.effective_share = e.evidence * e.evidence / squares / kDraws;
  e.evidence /= kDraws;
  e.evidence_sd = std::sqrt((squares / kDraws - e.evidence * e.evidence) / kDraws);
  return e;
}

TEST(EchoProposal, GivesTheEvidenceAndTheMeanOfTheMotionPrior) {
  const Situation s;
  ASSERT_EQ(s.map.size(), 3u);
  const ContourObservation observation(s.scan, s.none, 6, -9, s.parameters);
  const WhitenedMotion motion(s.motion);
  std::vector<char> scratch;
  std::vector<ContourLandmark> map = s.map;
  const double offset = observation.apply(s.motion.mean, map, scratch).log_likelihood;
  const Estimate prior = estimate(s, observation, offset, [&](Rng rng) {
    const Vector3 u(rng.normal(), rng.normal(), rng.normal());
    return DrawnPose{motion.moved({}, u), 0.0};
  });
  std::vector<std::int32_t> assigned;
  const Estimate informed = estimate(
      s, observation, offset, [&](const Rng& rng) { return observation.draw_pose({}, motion, s.map, assigned, rng); });
  EXPECT_NEAR(informed.evidence, prior.evidence, 4.0 * std::hypot(prior.evidence_sd, informed.evidence_sd));
  EXPECT_LT((informed.mean - prior.mean).norm(), 0.003);
  EXPECT_GT(informed.effective_share, 4.0 * prior.effective_share);
}

TEST(EchoProposal, IsTheMotionPriorWhereTheMapIsEmpty) {
  const Situation s;
  const ContourObservation observation(s.scan, s.none, 6, -9, s.parameters);
  const WhitenedMotion motion(s.motion);
  std::vector<std::int32_t> assigned;
  const Rng rng(7, stream_id("contour_proposal_test.empty"), 0);
  const DrawnPose drawn = observation.draw_pose({0.1, 0.2, 0.3}, motion, {}, assigned, rng);
  Rng same = rng;
  const Vector3 u(same.normal(), same.normal(), same.normal());
  const Pose2 expected = motion.moved({0.1, 0.2, 0.3}, u);
  EXPECT_NEAR(drawn.log_correction, 0.0, 1e-12);
  EXPECT_NEAR(drawn.pose.x, expected.x, 1e-12);
  EXPECT_NEAR(drawn.pose.yaw, expected.yaw, 1e-12);
}

TEST(EchoProposal, StaysWhereMotionIsCertain) {
  const Situation s;
  const ContourObservation observation(s.scan, s.none, 6, -9, s.parameters);
  const WhitenedMotion motion(PoseGaussian{{0.3, 0.0, 0.1}, Matrix3::Zero()});
  std::vector<std::int32_t> assigned;
  const DrawnPose drawn =
      observation.draw_pose({}, motion, s.map, assigned, Rng(7, stream_id("contour_proposal_test.certain"), 0));
  EXPECT_EQ(drawn.pose.x, 0.3);
  EXPECT_EQ(drawn.pose.yaw, 0.1);
  EXPECT_NEAR(drawn.log_correction, 0.0, 1e-12);
}

}  // namespace
}  // namespace noctule::filters
