#include "models/range_bearing.hpp"

#include <gtest/gtest.h>

#include "core/rng.hpp"

namespace noctule::models {
namespace {

TEST(RangeBearing, PlaceIsTheInverseOfPredict) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const Pose2 sensor{rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-kPi, kPi)};
    const Vector2 z(rng.uniform(0.1, 9), rng.uniform(-kPi, kPi));
    const auto placed = place_landmark(sensor, z);
    const auto predicted = predict_range_bearing(sensor, placed.landmark);
    EXPECT_NEAR(predicted.z[0], z[0], 1e-12);
    EXPECT_NEAR(wrap(predicted.z[1] - z[1]), 0.0, 1e-12);
    EXPECT_TRUE((predicted.by_landmark * placed.by_sighting).isApprox(Matrix2::Identity(), 1e-12));
  }
}

TEST(RangeBearing, JacobianMatchesCentralDifferences) {
  const Pose2 sensor{0.4, -0.2, 2.5};
  const Vector2 landmark(-1.0, 3.0);
  const auto p = predict_range_bearing(sensor, landmark);
  constexpr double step = 1e-6;
  for (int k = 0; k < 2; ++k) {
    Vector2 h = Vector2::Zero();
    h[k] = step;
    const Vector2 a = predict_range_bearing(sensor, landmark + h).z, b = predict_range_bearing(sensor, landmark - h).z;
    EXPECT_NEAR((a[0] - b[0]) / (2 * step), p.by_landmark(0, k), 1e-8);
    EXPECT_NEAR(wrap(a[1] - b[1]) / (2 * step), p.by_landmark(1, k), 1e-8);
  }
  EXPECT_TRUE(predict_range_bearing(sensor, sensor.position()).by_landmark.isZero());
}

}  // namespace
}  // namespace noctule::models
