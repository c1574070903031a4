#include <gtest/gtest.h>

#include "convert/convert.hpp"
#include "core/error.hpp"
#include "core/limits.hpp"
#include "unit/convert/random_values.hpp"
#include "unit/convert/same.hpp"

namespace noctule::convert {
namespace {

template <class Message>
std::string refusal(const Message& m) {
  try {
    (void)from_message(m);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// What from_message() says of a valid message after `spoil`.
template <class Value, class Spoil>
std::string refusal(const Value& value, Spoil spoil) {
  auto m = to_message(value);
  spoil(m);
  return refusal(m);
}

UltrasonicScan scan_of_two_beams() {
  UltrasonicScan scan;
  scan.max_range = 4.0;
  scan.beams.resize(2);
  return scan;
}

TEST(Refusal, NamesFieldExpectedAndGot) {
  const auto scan = scan_of_two_beams();
  EXPECT_EQ(refusal(scan, [](auto& m) { m.beams[1].range_m = kNan; }),
            "ultrasonic_scan.beams[1].range_m: expected a finite number >= 0, got nan");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.beams[0].range_m = -0.5; }),
            "ultrasonic_scan.beams[0].range_m: expected a finite number >= 0, got -0.5");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.beams[1].echo = 4; }),
            "ultrasonic_scan.beams[1].echo: expected a code from 0 to 3, got 4");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.beams[1].echo = -1; }),
            "ultrasonic_scan.beams[1].echo: expected a code from 0 to 3, got -1");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.beams[0].sensor_yaw_rad = kInf; }),
            "ultrasonic_scan.beams[0].sensor_yaw_rad: expected a finite number, got inf");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.beam_count = 3; }),
            "ultrasonic_scan.beam_count: expected the length of beams, 2, got 3");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.beam_count = -1; }),
            "ultrasonic_scan.beam_count: expected the length of beams, 2, got -1");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.min_range_m = 5.0; }),
            "ultrasonic_scan.max_range_m: expected a finite number >= 5, got 4");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.frame = "odom"; }),
            "ultrasonic_scan.frame: expected 'base_link', got 'odom'");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.seq = -2; }), "ultrasonic_scan.seq: expected an integer >= 0, got -2");
  EXPECT_EQ(refusal(scan, [](auto& m) { m.half_angle_rad = 30.0; }),
            "ultrasonic_scan.half_angle_rad: expected a finite number >= 0 <= 3.14159265, got 30");
}

TEST(Refusal, PixelsThatTheSizeDoesNotAccountFor) {
  CameraImage image;
  image.image = {.width = 3, .height = 2, .channels = 3, .pixels = std::vector<std::uint8_t>(18)};
  EXPECT_EQ(refusal(image, [](auto& m) { m.width = 0; }),
            "camera_image.width: expected an integer from 1 to 16384, got 0");
  EXPECT_EQ(refusal(image, [](auto& m) { m.height = -2; }),
            "camera_image.height: expected an integer from 1 to 16384, got -2");
  EXPECT_EQ(refusal(image, [](auto& m) { m.width = 2; }), "camera_image.byte_count: expected 12, got 18");
  EXPECT_EQ(refusal(image, [](auto& m) { m.width = 2'000'000'000; }),
            "camera_image.width: expected an integer from 1 to 16384, got 2000000000");
  EXPECT_EQ(refusal(image, [](auto& m) { m.encoding = camera_image::ENCODING_JPEG; }),
            "camera_image.encoding: expected a code from 0 to 1, got 2");
}

TEST(Refusal, NamesTheElementOfAListInAList) {
  ContourFeatures features;
  features.features.resize(3);
  features.features[2].readings.resize(2);
  EXPECT_EQ(refusal(features, [](auto& m) { m.features[2].readings[1].scan_seq = -1; }),
            "contour_features.features[2].readings[1].scan_seq: expected an integer >= 0, got -1");
  EXPECT_EQ(refusal(features, [](auto& m) { m.features[2].reading_count = 0; }),
            "contour_features.features[2].reading_count: expected the length of readings, 2, got 0");
  EXPECT_EQ(refusal(features, [](auto& m) { m.features[0].has_wall = 2; }),
            "contour_features.features[0].has_wall: expected 0 or 1, got 2");
}

TEST(Refusal, MatricesThatAreNoCovariance) {
  const Odometry odometry;
  const auto with = [&](int i, int j, double value) {
    return refusal(odometry, [&](auto& m) {
      for (int k = 0; k < 3; ++k) m.covariance_x_y_yaw_m_rad[k][k] = 1.0;
      m.covariance_x_y_yaw_m_rad[i][j] = value;
    });
  };
  EXPECT_EQ(with(1, 1, -0.1), "odometry.covariance_x_y_yaw_m_rad: expected finite variances >= 0, got -0.1");
  EXPECT_EQ(with(2, 2, kNan), "odometry.covariance_x_y_yaw_m_rad: expected finite variances >= 0, got nan");
  for (const auto& [i, j, value] : {std::tuple{0, 1, 0.5}, {1, 0, 0.5}, {2, 0, kNan}, {0, 2, kInf}})
    EXPECT_NE(with(i, j, value).find("expected a finite symmetric matrix"), std::string::npos) << with(i, j, value);

  const auto correlated = [&](double covariance) {
    return refusal(odometry, [&](auto& m) {
      auto& c = m.covariance_x_y_yaw_m_rad;
      c[0][0] = 4.0, c[1][1] = 9.0, c[0][1] = c[1][0] = covariance;
    });
  };
  EXPECT_EQ(correlated(6.0), "accepted") << "singular";
  EXPECT_EQ(correlated(-6.0 * (1.0 + 1e-9)), "accepted") << "rounding";
  EXPECT_NE(correlated(6.1), "accepted");
  EXPECT_NE(correlated(-6.1), "accepted");
}

TEST(Refusal, MapsOutsideTheirNormalForm) {
  ContourMap map;
  map.walls.resize(1);
  map.cylinders.resize(1);
  EXPECT_EQ(refusal(map, [](auto& m) { m.walls[0].rho_m = -1.0; }),
            "contour_map.walls[0].rho_m: expected a finite number >= 0, got -1");
  EXPECT_EQ(refusal(map, [](auto& m) { m.walls[0].begin_m = 1.0; }),
            "contour_map.walls[0].end_m: expected a finite number >= 1, got 0");
  EXPECT_EQ(refusal(map, [](auto& m) { m.cylinders[0].radius_m = kInf; }),
            "contour_map.cylinders[0].radius_m: expected a finite number >= 0, got inf");
}

/// Every double of a value, one at a time.
template <class Value>
void expect_refused_where_not_finite(Value value) {
  int count = 0;
  for_each_double(value, [&](double& number) {
    const double before = number;
    for (const double bad : {kNan, kInf, -kInf}) {
      number = bad;
      EXPECT_NE(refusal(to_message(value)), "accepted") << bad << " as double number " << count;
    }
    number = before;
    ++count;
  });
}

TEST(Refusal, NothingThatIsNotFiniteComesThrough) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomValues random(seed);
    expect_refused_where_not_finite(random.odometry());
    expect_refused_where_not_finite(random.ultrasonic_scan());
    expect_refused_where_not_finite(random.landmark_detections());
    expect_refused_where_not_finite(random.ground_truth());
    expect_refused_where_not_finite(random.slam_estimate());
    expect_refused_where_not_finite(random.contour_features());
    expect_refused_where_not_finite(random.path_estimate());
    expect_refused_where_not_finite(random.particle_cloud());
    expect_refused_where_not_finite(random.landmark_map());
    expect_refused_where_not_finite(random.contour_map());
  }
}

}  // namespace
}  // namespace noctule::convert
