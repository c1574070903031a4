#include "eval/consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/limits.hpp"

namespace noctule::eval {
namespace {

TEST(NormalisedSquare, ClosedFormAndRefusal) {
  const Matrix2 covariance = Vector2(4.0, 0.25).asDiagonal();
  const NormalisedSquare n = normalised_square<2>({2.0, 1.0}, covariance);
  EXPECT_NEAR(n.value, 1.0 + 4.0, 1e-12);
  EXPECT_EQ(n.dof, 2);
  EXPECT_TRUE(std::isnan(normalised_square<2>({1, 1}, Matrix2::Zero()).value));
  EXPECT_TRUE(std::isnan(normalised_square<2>({kNan, 1}, covariance).value));
  EXPECT_EQ(normalised_square<Eigen::Dynamic>(Eigen::VectorXd::Ones(5), Eigen::MatrixXd::Identity(5, 5)).value, 5.0);
}

TEST(LandmarkNees, OfWhatIsInTheMap) {
  LandmarkMap map;
  for (const std::int64_t id : {3, 4}) {
    LandmarkEstimate l;
    l.id = id;
    l.parameters = {1.0, 2.0, 0.0};
    l.covariance.topLeftCorner<2, 2>() = 0.25 * Matrix2::Identity();
    map.landmarks.push_back(l);
  }
  map.landmarks[1].kind = LandmarkKind::wall;
  const std::vector<KnownLandmark> known{{3, {1.0, 1.0}}, {4, {0, 0}}, {5, {0, 0}}};
  const auto values = landmark_nees(map, known);
  ASSERT_EQ(values.size(), 1u);
  EXPECT_NEAR(values[0].value, 4.0, 1e-12);
}

TEST(Consistency, AveragesRunsAtEachTime) {
  const std::vector<std::vector<NormalisedSquare>> runs{{{3.0, 3}, {90.0, 3}, {1.0, 3}}, {{6.0, 3}, {60.0, 3}}};
  const Consistency c = consistency(runs);
  ASSERT_EQ(c.steps.size(), 3u);
  EXPECT_EQ(c.steps[0].runs, 2);
  EXPECT_NEAR(c.steps[0].mean, 1.5, 1e-12);
  EXPECT_NEAR(c.steps[0].bounds.low, chi2_quantile(0.025, 6) / 6, 1e-12);
  EXPECT_NEAR(c.steps[0].bounds.high, chi2_quantile(0.975, 6) / 6, 1e-12);
  EXPECT_TRUE(c.steps[0].inside);
  EXPECT_FALSE(c.steps[1].inside);
  EXPECT_EQ(c.steps[2].runs, 1);
  EXPECT_NEAR(c.steps[2].bounds.high, chi2_quantile(0.975, 3) / 3, 1e-12);
  EXPECT_NEAR(c.mean, 160.0 / 15, 1e-12);
  EXPECT_NEAR(c.share_inside, 2.0 / 3, 1e-12);
  EXPECT_NEAR(c.share_above, 1.0 / 3, 1e-12);
  EXPECT_EQ(c.share_below, 0.0);
}

/// The bounds of M runs of 3 degrees of freedom, as printed in the literature (30 runs: [2.19, 3.94] / 3).
TEST(Consistency, BoundsAreTheKnownOnes) {
  const std::vector<std::vector<NormalisedSquare>> runs(30, {{3.0, 3}});
  const Consistency c = consistency(runs);
  EXPECT_NEAR(3 * c.steps[0].bounds.low, 2.19, 0.005);
  EXPECT_NEAR(3 * c.steps[0].bounds.high, 3.94, 0.005);
  EXPECT_NEAR(c.steps[0].bounds.low, nees_bounds(3, 30).low / 3, 1e-12);
}

TEST(Consistency, ScansOfDifferentSizeAddTheirDegreesOfFreedom) {
  const std::vector<std::vector<NormalisedSquare>> runs{{{4.0, 4}, {0.0, 0}}, {{2.0, 2}, {0.0, 0}}};
  const Consistency c = consistency(runs);
  EXPECT_NEAR(c.steps[0].mean, 1.0, 1e-12);
  EXPECT_NEAR(c.steps[0].bounds.low, chi2_quantile(0.025, 6) / 6, 1e-12);
  EXPECT_TRUE(std::isnan(c.steps[1].mean));
  EXPECT_EQ(c.share_inside, 1.0);  // of the one time that can be judged
}

TEST(Consistency, AValueThatIsNoNumberIsAFault) {
  const std::vector<std::vector<NormalisedSquare>> runs{{{3.0, 3}}, {{kNan, 3}}};
  const Consistency c = consistency(runs);
  EXPECT_EQ(c.failed, 1);
  EXPECT_EQ(c.steps[0].failed, 1);
  EXPECT_NEAR(c.mean, 1.0, 1e-12);
  EXPECT_FALSE(c.steps[0].inside);
  EXPECT_EQ(c.share_inside, 0.0);
}

TEST(Consistency, OfNothing) {
  EXPECT_TRUE(std::isnan(consistency({}).mean));
  EXPECT_TRUE(std::isnan(consistency({}).share_inside));
  EXPECT_THROW((void)consistency({}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
