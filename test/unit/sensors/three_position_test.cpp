#include "sensors/ultrasonic/three_position.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/limits.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::sensors {
namespace {

/// Noise-free sightings from equally spaced positions on the x axis, range sd 5 mm, direction sd 3 degrees.
template <class Surface>
std::vector<Sighting> along_x(int n, double length, const Surface& surface) {
  std::vector<Sighting> result;
  for (int i = 0; i < n; ++i) {
    Sighting s;
    s.position = {n > 1 ? length * i / (n - 1) : 0.0, 0.0};
    const auto echo = models::predict_echo(s.position, surface);
    s.range = echo.range;
    s.range_variance = 0.005 * 0.005;
    s.direction = echo.direction;
    s.direction_variance = std::pow(radians(3.0), 2);
    result.push_back(s);
  }
  return result;
}

const Wall kWall{1.0, radians(80.0)};
const Cylinder kCylinder{{0.4, 0.6}, 0.15};
const Cylinder kPoint{{0.4, 0.6}, 0.0};

TEST(SurfaceFits, AreExactWithoutNoise) {
  const auto wall = fit_wall(along_x(4, 0.6, kWall), {0.9, radians(70.0)});
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->parameters[0], kWall.rho, 1e-9);
  EXPECT_NEAR(wall->parameters[1], kWall.theta, 1e-9);
  const auto point = fit_point(along_x(4, 0.6, kPoint), {0.3, 0.7});
  ASSERT_TRUE(point);
  EXPECT_LT((point->parameters - kPoint.centre).norm(), 1e-9);
  const auto cylinder = fit_cylinder(along_x(5, 0.8, kCylinder), {{0.3, 0.7}, 0.05});
  ASSERT_TRUE(cylinder);
  EXPECT_LT((cylinder->parameters - Vector3(0.4, 0.6, 0.15)).norm(), 1e-9);
}

TEST(SurfaceFits, HaveNothingToSayAboutWhatTheNumbersDoNotDetermine) {
  auto ranges_only = along_x(1, 0.0, kWall);
  ranges_only[0].direction_variance = kInf;
  EXPECT_FALSE(fit_wall(ranges_only, kWall));
  EXPECT_FALSE(fit_point(ranges_only, kPoint.centre));
  EXPECT_FALSE(fit_cylinder(along_x(1, 0.0, kCylinder), kCylinder));  // no prior
  EXPECT_FALSE(fit_wall({}, kWall));
  EXPECT_FALSE(fit_wall(along_x(kMaxSightings + 1, 1.0, kWall), kWall));
}

TEST(SurfaceFits, EvidenceOfASingleSightingIsZeroForEverySurface) {
  auto s = along_x(1, 0.0, kWall);
  s[0].drift = Vector3(1e-4, 2e-4, 1e-4).asDiagonal();  // odometry since then changes nothing
  s[0].direction_bias_variance = 1e-4;
  const SurfaceFits fits = fit_surfaces(s, {});
  ASSERT_TRUE(fits.wall && fits.point && fits.cylinder);
  EXPECT_NEAR(fits.wall->log_evidence, 0.0, 1e-9);
  EXPECT_NEAR(fits.point->log_evidence, 0.0, 1e-9);
  EXPECT_NEAR(fits.cylinder->log_evidence, 0.0, 1e-9);
  const Decision d = decide(fits, 1, {});
  EXPECT_EQ(d.type, ContourType::ambiguous);
  EXPECT_NEAR(d.wall, 1.0 / 3.0, 1e-9);
}

TEST(SurfaceFits, OneOutlierIsFoundAndPaidFor) {
  auto s = along_x(8, 0.8, kWall);
  const auto clean = fit_wall(s, kWall, OutlierModel{});
  s[3].range += 0.06;
  const auto robust = fit_wall(s, kWall, OutlierModel{});
  const auto plain = fit_wall(s, kWall);
  ASSERT_TRUE(clean && robust && plain);
  EXPECT_EQ(clean->outliers, 0);
  EXPECT_EQ(robust->outliers, 1);
  EXPECT_LT(std::abs(robust->parameters[0] - kWall.rho), 0.2 * std::abs(plain->parameters[0] - kWall.rho));
  EXPECT_LT(robust->log_likelihood, clean->log_likelihood - std::log(0.95 / 0.05));
  EXPECT_GT(robust->log_likelihood, plain->log_likelihood);
}

TEST(Decide, TellsWallFromPointFromCylinderOnceTheBaselineIsLongEnough) {
  const DecisionParameters p;
  EXPECT_EQ(decide(fit_surfaces(along_x(5, 0.6, kWall), p), 5, p).type, ContourType::wall);
  EXPECT_EQ(decide(fit_surfaces(along_x(9, 1.2, kPoint), p), 9, p).type, ContourType::point);
  EXPECT_EQ(decide(fit_surfaces(along_x(9, 1.2, kCylinder), p), 9, p).type, ContourType::arc);
}

TEST(Decide, StaysAmbiguousOverAShortBaselineAndBelowThreePositions) {
  const DecisionParameters p;
  for (const double length : {0.02, 0.06}) {
    EXPECT_EQ(decide(fit_surfaces(along_x(3, length, kWall), p), 3, p).type, ContourType::ambiguous);
    EXPECT_EQ(decide(fit_surfaces(along_x(3, length, kPoint), p), 3, p).type, ContourType::ambiguous);
  }
  EXPECT_EQ(decide(fit_surfaces(along_x(2, 2.0, kWall), p), 2, p).type, ContourType::ambiguous);
}

TEST(Decide, KnowsThatASurfaceIsCurvedBeforeItsRadius) {
  const DecisionParameters p;
  const Decision d = decide(fit_surfaces(along_x(4, 0.4, kCylinder), p), 4, p);
  EXPECT_EQ(d.type, ContourType::ambiguous);
  EXPECT_LT(d.wall, 0.01);
}

TEST(Decide, SightingsThatNothingExplainsAreReported) {
  auto s = along_x(3, 0.6, kWall);
  s[1].range += 0.5;
  s[1].direction += 2.0;
  EXPECT_FALSE(decide(fit_surfaces(s, {}), 3, {}).explained);
}

TEST(FitSurfaces, TheMirrorImageBehindTheRobotIsNotTaken) {
  for (const double side : {-1.0, 1.0}) {
    const Wall wall{1.0, side * radians(80.0)};
    const auto fits = fit_surfaces(along_x(3, 0.8, wall), {});
    ASSERT_TRUE(fits.wall);
    EXPECT_NEAR(wrap(fits.wall->parameters[1] - wall.theta), 0.0, 1e-6);
  }
}

TEST(FitSurfaces, AHopelessSurfaceIsNotFitted) {
  EXPECT_FALSE(fit_surfaces(along_x(6, 0.8, kCylinder), {}).wall);
}

/// Up to the iteration's tolerance, a thousandth of a standard deviation.
TEST(FitSurfaces, GoesOnFromThePreviousFitsToTheSameResult) {
  const auto s = along_x(6, 0.8, kCylinder);
  const SurfaceFits fresh = fit_surfaces(s, {});
  const SurfaceFits again = fit_surfaces(s, {}, fit_surfaces(std::span(s).first(3), {}));
  ASSERT_TRUE(fresh.cylinder && again.cylinder && fresh.point && again.point);
  EXPECT_LT((fresh.cylinder->parameters - again.cylinder->parameters).norm(), 1e-5);
  EXPECT_LT((fresh.point->parameters - again.point->parameters).norm(), 1e-5);
  EXPECT_NEAR(fresh.cylinder->log_evidence, again.cylinder->log_evidence, 1e-3);
}

TEST(WidestTriple, TakesTheEndsAndTheMiddle) {
  const auto s = along_x(7, 0.6, kWall);
  const Triple t = widest_triple(s);
  ASSERT_EQ(t.count, 3u);
  EXPECT_EQ(t.sightings[0].position, s[0].position);
  EXPECT_EQ(t.sightings[1].position, s[3].position);
  EXPECT_EQ(t.sightings[2].position, s[6].position);
}

}  // namespace
}  // namespace noctule::sensors
