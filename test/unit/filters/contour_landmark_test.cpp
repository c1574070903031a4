#include "filters/slam/contour_landmark.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace noctule::filters {
namespace {

PlacedEcho echo_at(const Vector2& sensor, double axis, double range, double sd = 0.01) {
  return {.sensor = sensor,
          .axis = {std::cos(axis), std::sin(axis)},
          .gate_cosine = std::cos(0.5),
          .range = range,
          .range_variance = sd * sd,
          .bearing_variance = 0.13 * 0.13};
}

ContourFeature feature(ContourType type, const Vector2& surface) {
  ContourFeature f;
  f.type = type;
  f.surface = surface;
  return f;
}

constexpr double kLogClutter = -7.0;

TEST(ContourLandmark, LikelihoodIsADensityOfRangeAndDirection) {
  const ContourLandmarkParameters p;
  const Pose2 base{0.3, -0.1, 0.4};
  for (const auto type : {ContourType::wall, ContourType::arc, ContourType::point, ContourType::ambiguous}) {
    const ContourLandmark landmark(feature(type, {0.9, 0.2}), base, 1, 0, p);
    double mass = 0.0;
    constexpr double dr = 0.005, da = 0.01;
    for (double axis = -kPi; axis < kPi; axis += da) {
      auto echo = echo_at(base.position(), axis, 0.0);
      echo.gate_cosine = -1.0;
      for (echo.range = 0.0; echo.range < 2.0; echo.range += dr) {
        mass += std::exp(landmark.log_likelihood(echo)) * dr * da;
      }
    }
    EXPECT_NEAR(mass, 1.0, 2e-3);
  }
}

TEST(ContourLandmark, OutOfViewMeansImpossible) {
  const ContourLandmarkParameters p;
  const ContourLandmark wall(feature(ContourType::wall, {1.0, 0.0}), {}, 1, 0, p);
  EXPECT_TRUE(std::isfinite(wall.log_likelihood(echo_at({0.0, 0.0}, 0.4, 1.0))));
  EXPECT_FALSE(std::isfinite(wall.log_likelihood(echo_at({0.0, 0.0}, 0.6, 1.0))));  // outside the cone
  EXPECT_FALSE(std::isfinite(wall.log_likelihood(echo_at({1.5, 0.0}, 0.0, 0.5))));  // behind the wall
  EXPECT_FALSE(std::isfinite(wall.log_likelihood(echo_at({0.0, 0.0}, kPi, 1.0))));  // facing away
  const ContourLandmark point(feature(ContourType::point, {1.0, 0.0}), {}, 1, 0, p);
  EXPECT_TRUE(std::isfinite(point.log_likelihood(echo_at({2.0, 0.0}, kPi, 1.0))));  // a point has no back
}

TEST(ContourLandmark, PriorIsAsWideAsToldAlongTheLineOfSight) {
  const ContourLandmarkParameters p;
  const Pose2 base{2.0, 1.0, 0.7};
  const Vector2 surface(1.2, -0.5);
  const auto e = ContourLandmark(feature(ContourType::arc, surface), base, 1, 0, p).estimate();
  const Vector2 along = Pose2{0, 0, base.yaw} * surface.normalized();
  const Vector2 nearest = e.parameters.head<2>() - e.parameters[2] * along;
  EXPECT_LT((nearest - base * surface).norm(), 1e-12);
  // Variance of the nearest point of the surface, c - R u: along the line of sight, and across it.
  Eigen::Matrix<double, 2, 3> j;
  j << Matrix2::Identity(), -along;
  const Matrix2 s = j * e.covariance * j.transpose();
  const Vector2 across(-along.y(), along.x());
  EXPECT_NEAR(std::sqrt(along.dot(s * along)), p.range_sd, 1e-12);
  EXPECT_NEAR(std::sqrt(across.dot(s * across)), p.direction_sd * surface.norm(), 1e-12);
  EXPECT_NEAR(std::sqrt(e.covariance(2, 2)), p.radius_sd, 1e-12);
}

TEST(ContourLandmark, TakesTheRadiusOfTheExtractorOnlyWhenItKnowsOne) {
  const ContourLandmarkParameters p;
  ContourFeature f = feature(ContourType::arc, {1.0, 0.0});
  f.has_circle = true;
  f.circle = {{1.25, 0.0}, 0.25};
  f.circle_covariance(2, 2) = 0.04 * 0.04;
  EXPECT_NEAR(ContourLandmark(f, {}, 1, 0, p).estimate().parameters[2], 0.25, 1e-12);
  f.circle_covariance(2, 2) = 5.0 * 5.0;  // a short baseline
  EXPECT_NEAR(ContourLandmark(f, {}, 1, 0, p).estimate().parameters[2], p.radius, 1e-12);
}

TEST(ContourLandmark, WallEstimateIsNormalisedWithItsCovariance) {
  // Seen from beyond the origin: the normal points back towards it, so that rho changes sign on output.
  const ContourLandmarkParameters p;
  const Pose2 base{3.0, 2.0, kPi};
  const auto e = ContourLandmark(feature(ContourType::wall, {1.0, 0.0}), base, 1, 0, p).estimate();
  EXPECT_NEAR(e.parameters[0], 2.0, 1e-12);
  EXPECT_NEAR(wrap(e.parameters[1]), 0.0, 1e-12);
  // The wall x = 2: rho = 2 for any small turn about the point nearest to the base, (2, 2): d rho / d theta = 2.
  EXPECT_NEAR(e.covariance(1, 1), p.direction_sd * p.direction_sd, 1e-12);
  EXPECT_NEAR(e.covariance(0, 1), 2.0 * p.direction_sd * p.direction_sd, 1e-12);
  EXPECT_NEAR(e.covariance(0, 0), p.range_sd * p.range_sd + 4.0 * p.direction_sd * p.direction_sd, 1e-12);
}

TEST(ContourLandmark, TypeStaysOpenUntilRatioAndStopsSuffice) {
  ContourLandmarkParameters p;
  ContourLandmark landmark(feature(ContourType::ambiguous, {1.0, 0.0}), {}, 1, 0, p);
  const Wall truth{1.0, 0.0};
  EXPECT_EQ(landmark.kind(), LandmarkKind::undecided);
  // From one stop nothing can be decided, whatever it hears.
  for (int k = 0; k < 50; ++k) landmark.assimilate(echo_at({0.0, 0.0}, 0.0, 1.0), kLogClutter, 0, p);
  EXPECT_EQ(landmark.kind(), LandmarkKind::undecided);
  for (int stop = 1; stop < 20 && landmark.kind() == LandmarkKind::undecided; ++stop) {
    const Vector2 sensor(0.0, 0.1 * stop);
    landmark.assimilate(echo_at(sensor, 0.0, truth.distance(sensor)), kLogClutter, stop, p);
  }
  EXPECT_EQ(landmark.kind(), LandmarkKind::wall);
}

TEST(ContourLandmark, AnEchoThatFitsNeitherTypeDecidesNothing) {
  const ContourLandmarkParameters p;
  ContourLandmark landmark(feature(ContourType::ambiguous, {1.0, 0.0}), {}, 1, 0, p);
  for (int k = 0; k < 20; ++k) landmark.assimilate(echo_at({0.0, 0.0}, 0.0, 1.0), kLogClutter, 0, p);
  const auto before = landmark.estimate();
  for (int stop = 1; stop < 10; ++stop) {
    landmark.assimilate(echo_at({0.0, 0.0}, 0.0, 1.5), kLogClutter, stop, p);
  }
  EXPECT_EQ(landmark.kind(), LandmarkKind::undecided);
  EXPECT_EQ(landmark.estimate().parameters, before.parameters);
}

}  // namespace
}  // namespace noctule::filters
