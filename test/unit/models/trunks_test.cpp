#include "models/trunks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/rng.hpp"

namespace noctule::models {
namespace {

constexpr double kFar = 81.9, kStep = kPi / 360.0;

/// What a scanner at the origin sees of circles (centre, radius), a beam every half degree from -90 to 90 degrees.
struct Circle {
  Vector2 centre;
  double radius;
};
std::vector<double> scan(const std::vector<Circle>& circles) {
  std::vector<double> ranges(361, kFar);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = -0.5 * kPi + static_cast<double>(i) * kStep;
    const Vector2 u(std::cos(angle), std::sin(angle));
    for (const Circle& c : circles) {
      const double along = u.dot(c.centre), off2 = c.centre.squaredNorm() - along * along;
      if (along <= 0.0 || off2 > c.radius * c.radius) continue;
      ranges[i] = std::min(ranges[i], along - std::sqrt(c.radius * c.radius - off2));
    }
  }
  return ranges;
}

std::vector<LandmarkDetection> found(const std::vector<double>& ranges, const TrunkParameters& p = {}) {
  return find_trunks({-0.5 * kPi, kStep, 80.0, ranges}, p);
}

TEST(Trunks, CentresNotFrontsAreMeasured) {
  const auto trunks = found(scan({{{10.0, 0.0}, 0.45}, {{6.0, 6.0}, 0.2}}));
  ASSERT_EQ(trunks.size(), 2u);
  EXPECT_NEAR(trunks[0].range, 10.0, 0.1);  // the front is at 9.55
  EXPECT_NEAR(trunks[0].bearing, 0.0, kStep);
  EXPECT_NEAR(trunks[1].range, std::hypot(6.0, 6.0), 0.06);
  EXPECT_NEAR(trunks[1].bearing, 0.25 * kPi, kStep);
  EXPECT_EQ(trunks[0].id, -1);
}

TEST(Trunks, TheirPlacesAreUnbiasedAndTheirSpreadIsWhatTheSpacingOfTheBeamsDoes) {
  TrunkParameters p;
  p.range_sd = p.bearing_sd = 1e-6;  // the spacing alone
  std::vector<double> range, bearing;
  double range_variance = 0.0, bearing_variance = 0.0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Rng rng(1, stream_id("trunks"), i);
    const double distance = rng.uniform(10.0, 14.0), angle = rng.uniform(-1.0, 1.0);
    p.range_sd = 1.0;  // lets the depth test alone
    const auto trunks = found(scan({{{distance * std::cos(angle), distance * std::sin(angle)}, 0.35}}), p);
    ASSERT_EQ(trunks.size(), 1u);
    range.push_back(trunks[0].range - distance);
    bearing.push_back(trunks[0].bearing - angle);
    range_variance += trunks[0].covariance(0, 0) - 1.0;
    bearing_variance += trunks[0].covariance(1, 1);
  }
  const auto n = static_cast<double>(range.size());
  const auto mean = [&](const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0) / n; };
  const auto square = [&](const std::vector<double>& v) {
    return std::inner_product(v.begin(), v.end(), v.begin(), 0.0) / n;
  };
  EXPECT_NEAR(mean(range), 0.0, 0.01);
  EXPECT_NEAR(mean(bearing), 0.0, 5.0 * std::sqrt(bearing_variance / n / n));
  // The edges of one circle are not independent: the stated variance is right within a factor.
  EXPECT_GT(bearing_variance / n, 0.5 * square(bearing));
  EXPECT_LT(bearing_variance / n, 2.0 * square(bearing));
  EXPECT_GT(range_variance / n, 0.5 * square(range));
  EXPECT_LT(range_variance / n, 2.0 * square(range));
}

TEST(Trunks, WallsHiddenThingsAndCutOnesAreNone) {
  std::vector<double> wall(361, kFar);
  for (std::size_t i = 120; i < 240; ++i) wall[i] = 10.0 / std::cos(-0.5 * kPi + static_cast<double>(i) * kStep);
  EXPECT_TRUE(found(wall).empty());

  std::vector<double> slanting(361, kFar);  // narrow, but deep
  for (std::size_t i = 180; i < 184; ++i) slanting[i] = 10.0 + 0.4 * static_cast<double>(i - 180);
  EXPECT_TRUE(found(slanting).empty());

  const auto hidden = found(scan({{{10.0, 0.0}, 0.3}, {{11.5, 0.45}, 0.3}}));  // the nearer one stands in front
  EXPECT_TRUE(hidden.empty() || (hidden.size() == 1 && hidden[0].range < 10.5));

  EXPECT_TRUE(found(scan({{{0.05, 10.0}, 0.3}})).empty());  // at the end of the fan
  EXPECT_TRUE(found(scan({{{60.0, 0.0}, 0.5}})).empty());   // too far
  EXPECT_TRUE(found(std::vector<double>{}).empty());
  EXPECT_TRUE(found(std::vector<double>(361, 0.0)).empty());
}

TEST(Trunks, LeftAndRightAreMirrorImages) {
  const std::vector<Circle> circles{{{8.0, 2.0}, 0.3}, {{12.0, -5.0}, 0.25}};
  std::vector<double> ranges = scan(circles);
  const auto trunks = found(ranges);
  std::reverse(ranges.begin(), ranges.end());
  const auto mirrored = found(ranges);
  ASSERT_EQ(trunks.size(), 2u);
  ASSERT_EQ(mirrored.size(), 2u);
  EXPECT_NEAR(mirrored[0].bearing, -trunks[1].bearing, 1e-12);
  EXPECT_NEAR(mirrored[0].range, trunks[1].range, 1e-12);
}

}  // namespace
}  // namespace noctule::models
