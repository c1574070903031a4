#include "eval/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "core/limits.hpp"
#include "eval/number_text.hpp"
#include "eval/tum.hpp"

namespace noctule::eval {
namespace {

TEST(Interpolate, LinearInPositionAndTheShorterWayInHeading) {
  const std::vector<TimedPose> t{{1'000'000, {0, 0, 3.0}}, {3'000'000, {2, -4, -3.0}}};
  const Pose2 p = *interpolate(t, 1'500'000);
  EXPECT_NEAR(p.x, 0.5, 1e-15);
  EXPECT_NEAR(p.y, -1.0, 1e-15);
  EXPECT_NEAR(p.yaw, 3.0 + 0.25 * (kTwoPi - 6.0), 1e-12);
  EXPECT_EQ(*interpolate(t, 3'000'000), t[1].pose);
  EXPECT_FALSE(interpolate(t, 999'999));
  EXPECT_FALSE(interpolate(t, 3'000'001));
  EXPECT_FALSE(interpolate(t, 2'000'000, 1.9));
  EXPECT_TRUE(interpolate(t, 2'000'000, 2.0));
  EXPECT_FALSE(interpolate({}, 0));
}

TEST(Associate, LeavesOutWhatHasNoTruth) {
  const std::vector<TimedPose> truth{{0, {0, 0, 0}}, {10, {1, 0, 0}}};
  const std::vector<TimedPose> estimate{{-5, {}}, {5, {0.7, 0, 0}}, {15, {}}};
  const auto pairs = associate(estimate, truth);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_NEAR(pairs[0].truth.x, 0.5, 1e-15);
}

TEST(PoseErrors, ClosedForm) {
  const std::vector<PosePair> pairs{{0, {3, 4, kPi - 0.1}, {0, 0, -kPi + 0.1}}, {1, {0, 0, 0}, {0, 0, 0}}};
  const PoseErrors e = pose_errors(pairs);
  EXPECT_EQ(e.samples, 2);
  EXPECT_NEAR(e.position_rmse, 5 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(e.position_max, 5, 1e-12);
  EXPECT_NEAR(e.heading_rmse, 0.2 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(e.heading_max, 0.2, 1e-12);
  EXPECT_TRUE(std::isnan(pose_errors({}).position_rmse));
}

TEST(Align, RecoversAKnownMotion) {
  const Similarity2 truth{1.7, -2.2, {0.4, -3.0}};
  const std::vector<Vector2> source{{0, 0}, {1, 0.5}, {-2, 1}, {0.3, -4}};
  std::vector<Vector2> target;
  for (const Vector2& p : source) target.push_back(truth * p);
  const Similarity2 found = align(source, target, Alignment::similarity);
  EXPECT_NEAR(found.scale, truth.scale, 1e-12);
  EXPECT_NEAR(found.rotation, truth.rotation, 1e-12);
  EXPECT_NEAR((found.translation - truth.translation).norm(), 0, 1e-12);
  EXPECT_EQ(align(source, target, Alignment::rigid).scale, 1.0);
  EXPECT_NEAR(align(source, target, Alignment::rigid).rotation, truth.rotation, 1e-12);
  EXPECT_EQ(align(source, target, Alignment::none).rotation, 0.0);
}

TEST(Align, OnePointGivesATranslation) {
  const std::vector<Vector2> source{{1, 2}, {1, 2}}, target{{5, 5}, {5, 5}};
  const Similarity2 s = align(source, target, Alignment::similarity);
  EXPECT_EQ(s.scale, 1.0);
  EXPECT_EQ(s.rotation, 0.0);
  EXPECT_EQ(s.translation, Vector2(4, 3));
  EXPECT_THROW((void)align(source, std::vector<Vector2>{{0, 0}}, Alignment::rigid), std::invalid_argument);
}

TEST(AbsoluteTrajectoryError, IsTheResidualOfTheFit) {
  // A square whose corners move outwards by 0.1: only a scale can take that away.
  std::vector<PosePair> pairs;
  for (const Vector2& c : {Vector2(1, 1), Vector2(-1, 1), Vector2(-1, -1), Vector2(1, -1)}) {
    const Vector2 e = c * 1.1 + Vector2(2, 3);
    pairs.push_back({static_cast<std::int64_t>(pairs.size()), {e.x(), e.y(), 0}, {c.x(), c.y(), 0}});
  }
  EXPECT_NEAR(absolute_trajectory_error(pairs, Alignment::rigid), 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(absolute_trajectory_error(pairs, Alignment::similarity), 0.0, 1e-12);
  EXPECT_TRUE(std::isnan(absolute_trajectory_error({}, Alignment::rigid)));
}

TEST(Segments, BeginAtEachMoveAndEndAtTheLength) {
  std::vector<PosePair> pairs;
  for (const double x : {0.0, 0.5, 0.5, 1.0, 1.5, 2.0}) {
    pairs.push_back({static_cast<std::int64_t>(pairs.size()), {}, {x, 0, 0}});
  }
  EXPECT_EQ(segments_by_length(pairs, 1.0), (std::vector<Segment>{{0, 3}, {1, 4}, {3, 5}}));
  EXPECT_TRUE(segments_by_length(pairs, 2.1).empty());
}

TEST(RelativePoseErrors, OfAScaledAndTurningOdometer) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 5; ++i) pairs.push_back({i, {1.02 * i, 0, 0.0}, {1.0 * i, 0, 0}});
  RelativePoseErrors e = relative_pose_errors(pairs, segments_by_steps(pairs.size(), 2, SegmentStarts::every_pose));
  EXPECT_EQ(e.segments, 3);
  EXPECT_NEAR(e.translation_rmse, 0.04, 1e-12);
  EXPECT_NEAR(e.rotation_rmse, 0.0, 1e-12);
  for (int i = 0; i < 5; ++i) pairs[static_cast<std::size_t>(i)].estimate = {1.0 * i, 0, 0.1 * i};
  e = relative_pose_errors(pairs, segments_by_steps(pairs.size(), 1, SegmentStarts::every_pose));
  EXPECT_NEAR(e.rotation_rmse, 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(relative_pose_errors(pairs, {}).translation_rmse));
}

TEST(Nees, ClosedFormAndRefusal) {
  const Matrix3 covariance = Vector3(0.04, 0.25, 0.01).asDiagonal();
  EXPECT_NEAR(nees({1.2, 1.5, -kPi + 0.05}, covariance, {1, 1, kPi - 0.05}), 1 + 1 + 1, 1e-9);
  EXPECT_TRUE(std::isnan(nees({}, Matrix3::Zero(), {})));
  EXPECT_TRUE(std::isnan(nees({}, -covariance, {})));
}

TEST(NeesSummary, CountsOnlyWhatIsANumber) {
  const std::vector<double> values{kNan, 3.0, 0.1, 20.0};
  const NeesSummary s = nees_summary(values);
  EXPECT_EQ(s.samples, 3);
  EXPECT_NEAR(s.mean, 23.1 / 3, 1e-12);
  EXPECT_EQ(s.median, 3.0);
  EXPECT_NEAR(s.step_bounds.low, 0.2158, 1e-4);
  EXPECT_NEAR(s.step_bounds.high, 9.3484, 1e-4);
  EXPECT_NEAR(s.inside, 1.0 / 3, 1e-12);
  EXPECT_TRUE(std::isnan(nees_summary({}).mean));
  EXPECT_TRUE(std::isnan(nees_summary({}).median));
}

TEST(LeavesForGood, AfterTheLastValueInside) {
  const Interval bounds{1.0, 2.0};
  const auto index = [&](std::vector<double> values) { return leaves_for_good(values, bounds); };
  EXPECT_EQ(index({}), 0u);
  EXPECT_EQ(index({3.0, 0.5, kNan}), 0u);
  EXPECT_EQ(index({1.5, 3.0, 2.0, 0.9, kNan}), 3u);
  EXPECT_EQ(index({kNan, 9.0, 1.0}), 3u);
}

LandmarkMap landmark_map(std::initializer_list<std::pair<int, Vector2>> points) {
  LandmarkMap map;
  for (const auto& [id, p] : points) {
    LandmarkEstimate l;
    l.id = id;
    l.parameters << p, 0.0;
    map.landmarks.push_back(l);
  }
  return map;
}

TEST(LandmarkErrors, ByIdentity) {
  const std::vector<KnownLandmark> known{{7, {1, 0}}, {8, {0, 2}}, {9, {5, 5}}};
  LandmarkMap map = landmark_map({{8, {0, 2.3}}, {7, {1.4, 0}}, {30, {9, 9}}});
  map.landmarks.push_back({.id = 9, .kind = LandmarkKind::wall, .parameters = {5, 0, 0}});
  const LandmarkErrors e = landmark_errors(map, known);
  EXPECT_EQ(e.found, 2);
  EXPECT_EQ(e.missed, 1);
  EXPECT_EQ(e.invented, 1);
  EXPECT_NEAR(e.rmse, std::sqrt((0.09 + 0.16) / 2), 1e-12);
  EXPECT_NEAR(e.mean, 0.35, 1e-12);
  EXPECT_NEAR(e.max, 0.4, 1e-12);
}

TEST(LandmarkErrors, ByDistanceWithinTheGate) {
  const std::vector<KnownLandmark> known{{0, {1, 0}}, {1, {0, 2}}};
  const LandmarkErrors e = landmark_errors(landmark_map({{50, {0, 2.5}}, {51, {3, 0}}}), known, {.known_ids = false});
  EXPECT_EQ(e.found, 1);
  EXPECT_EQ(e.missed, 1);
  EXPECT_EQ(e.invented, 1);
  EXPECT_NEAR(e.rmse, 0.5, 1e-12);
}

TEST(LandmarkErrors, AlignmentTakesACommonMotionAway) {
  const std::vector<KnownLandmark> known{{0, {1, 0}}, {1, {0, 2}}, {2, {-3, 1}}};
  const Pose2 motion{1, 2, 0.4};
  LandmarkMap map;
  for (const KnownLandmark& k : known) {
    LandmarkEstimate l;
    l.id = k.id;
    l.parameters << motion * k.position, 0.0;
    map.landmarks.push_back(l);
  }
  EXPECT_GT(landmark_errors(map, known).rmse, 1.0);
  EXPECT_NEAR(landmark_errors(map, known, {.alignment = Alignment::rigid}).rmse, 0.0, 1e-12);
  EXPECT_TRUE(std::isnan(landmark_errors({}, known).rmse));
  EXPECT_TRUE(std::isnan(landmark_errors({}, known).mean));
}

TEST(Tum, ReadsBackExactly) {
  const std::vector<TimedPose> trajectory{{1'600'000'123'456, {0.1, -1.0 / 3, 2.9}},
                                          {5, {1e-300, 12345.678901234567, -3}}};
  std::istringstream text(to_tum(trajectory));
  for (const TimedPose& p : trajectory) {
    double t, x, y, z, qx, qy, qz, qw;
    ASSERT_TRUE(text >> t >> x >> y >> z >> qx >> qy >> qz >> qw);
    EXPECT_EQ(std::llround(t * 1e6), p.utime);
    EXPECT_EQ(x, p.pose.x);
    EXPECT_EQ(y, p.pose.y);
    EXPECT_EQ(z, 0.0);
    EXPECT_EQ(qx, 0.0);
    EXPECT_EQ(qy, 0.0);
    EXPECT_NEAR(2 * std::atan2(qz, qw), p.pose.yaw, 1e-15);
    EXPECT_NEAR(qz * qz + qw * qw, 1.0, 1e-15);
  }
  EXPECT_EQ(to_tum(std::vector<TimedPose>{{1'500'000, {1, 2, 0}}}), "1.500000 1 2 0 0 0 0 1\n");
  EXPECT_EQ(to_tum(std::vector<TimedPose>{{-1'500'000, {}}}).substr(0, 9), "-1.500000");
}

TEST(Shortest, RoundTrips) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(-0.0), "-0");
  EXPECT_EQ(shortest(1e22), "1e+22");
  for (const double v : {1.0 / 3, 5e-324, 1.7976931348623157e308, 123456.789}) {
    EXPECT_EQ(std::strtod(shortest(v).c_str(), nullptr), v);
  }
}

}  // namespace
}  // namespace noctule::eval
