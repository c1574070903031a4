#include <gtest/gtest.h>

#include "bus/codec.hpp"
#include "convert/convert.hpp"
#include "unit/convert/random_values.hpp"
#include "unit/convert/same.hpp"

namespace noctule::convert {
namespace {

/// Value -> message -> bytes -> message -> value.
template <class Value>
Value round_trip(const Value& value) {
  const auto message = to_message(value);
  std::vector<std::uint8_t> bytes;
  bus::encode(message, bytes);
  return from_message(bus::decode<std::remove_const_t<decltype(message)>>(bytes));
}

TEST(Convert, EveryValueSurvivesTheWayOverTheBusToTheBit) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomValues random(seed);
    const auto expect_same = [&](const auto& value) {
      EXPECT_TRUE(same(round_trip(value), value)) << to_message(value).getTypeName() << ", seed " << seed;
    };
    expect_same(random.odometry());
    expect_same(random.ultrasonic_scan());
    expect_same(random.landmark_detections());
    expect_same(random.ground_truth());
    expect_same(random.contour_features());
    expect_same(random.slam_estimate());
    expect_same(random.path_estimate());
    expect_same(random.particle_cloud());
    expect_same(random.landmark_map());
    expect_same(random.contour_map());
    expect_same(random.camera_image());
  }
}

TEST(Convert, DefaultValuesAreValid) {
  EXPECT_TRUE(same(round_trip(Odometry{}), Odometry{}));
  EXPECT_TRUE(same(round_trip(UltrasonicScan{}), UltrasonicScan{}));
  EXPECT_TRUE(same(round_trip(SlamEstimate{}), SlamEstimate{}));
  EXPECT_TRUE(same(round_trip(ContourMap{}), ContourMap{}));
}

TEST(Convert, NegativeZeroAndTheSmallestNumbersSurvive) {
  Odometry value;
  value.increment = {-0.0, 5e-324, 1.7976931348623157e308};
  EXPECT_TRUE(same(round_trip(value), value));
}

}  // namespace
}  // namespace noctule::convert
