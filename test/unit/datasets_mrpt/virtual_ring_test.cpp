#include "datasets_mrpt/virtual_ring.hpp"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <cmath>
#include <vector>

#include "core/error.hpp"
#include "core/pose2.hpp"

namespace noctule::datasets {
namespace {

using mrpt::obs::CObservation2DRangeScan;

// A scanner that looks at the wall x = `distance` of its own frame, beams every half degree.
CObservation2DRangeScan scanner_before_wall(double distance, double aperture, bool right_to_left = true) {
  CObservation2DRangeScan laser;
  const int n = static_cast<int>(std::lround(degrees(aperture) * 2.0)) + 1;
  std::vector<float> ranges(static_cast<std::size_t>(n));
  std::vector<char> valid(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) {
    const double angle = aperture * (static_cast<double>(i) / (n - 1) - 0.5);
    const std::size_t k = static_cast<std::size_t>(right_to_left ? i : n - 1 - i);
    valid[k] = std::cos(angle) > 0.05;
    ranges[k] = static_cast<float>(distance / std::max(std::cos(angle), 0.05));
  }
  laser.aperture = static_cast<float>(aperture);
  laser.rightToLeft = right_to_left;
  laser.loadFromVectors(ranges.size(), ranges.data(), valid.data());
  return laser;
}

TEST(VirtualRing, HearsTheNearestReturnInsideEachCone) {
  const double half_angle = radians(10.0), distance = 1.3;
  const auto laser = scanner_before_wall(distance, kPi);
  const UltrasonicScan scan = virtual_scan(laser, {.sensors = 9, .half_angle = half_angle, .max_range = 3.0}, "here");
  ASSERT_EQ(scan.beams.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) {
    const double axis = radians(-80.0 + 20.0 * static_cast<double>(i));
    EXPECT_NEAR(scan.beams[i].sensor_in_base.yaw, axis, 1e-6);
    const double nearest = distance / std::cos(std::max(0.0, std::abs(axis) - half_angle));
    EXPECT_EQ(scan.beams[i].echo, nearest <= 3.0 ? Echo::hit : Echo::none) << i;
    EXPECT_NEAR(scan.beams[i].range, nearest <= 3.0 ? nearest : 0.0, 1e-5) << i;
  }
  EXPECT_EQ(scan.half_angle, half_angle);
}

TEST(VirtualRing, TheSenseOfTheScanMakesNoDifference) {
  auto a = scanner_before_wall(1.0, kPi, true), b = scanner_before_wall(1.0, kPi, false);
  a.setScanRange(20, 0.3f);  // something on the right
  b.setScanRange(340, 0.3f);
  const VirtualRing ring{.sensors = 5};
  const auto sa = virtual_scan(a, ring, ""), sb = virtual_scan(b, ring, "");
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(sa.beams[i].sensor_in_base, sb.beams[i].sensor_in_base);
    EXPECT_NEAR(sa.beams[i].range, sb.beams[i].range, 1e-6);
  }
  EXPECT_NEAR(sa.beams[0].range, 0.3, 1e-6);
}

TEST(VirtualRing, StandsWhereTheScannerStands) {
  auto laser = scanner_before_wall(1.0, kPi);
  laser.sensorPose = mrpt::poses::CPose3D(0.4, -0.1, 0.3, radians(30.0), 0.0, 0.0);
  const UltrasonicScan scan = virtual_scan(laser, {.yaws = {radians(30.0), radians(75.0)}}, "");
  ASSERT_EQ(scan.beams.size(), 2u);
  EXPECT_NEAR(scan.beams[0].sensor_in_base.x, 0.4, 1e-12);
  EXPECT_NEAR(scan.beams[0].sensor_in_base.y, -0.1, 1e-12);
  EXPECT_NEAR(scan.beams[1].sensor_in_base.yaw, radians(75.0), 1e-12);
  EXPECT_NEAR(scan.beams[0].range, 1.0, 1e-5);
  EXPECT_NEAR(scan.beams[1].range, 1.0 / std::cos(radians(35.0)), 1e-3);
}

TEST(VirtualRing, PassesOverReturnsThatAreNotValid) {
  auto laser = scanner_before_wall(1.0, kPi);
  for (std::size_t i = 160; i <= 200; ++i) {
    laser.setScanRange(i, i == 180 ? std::nanf("") : 0.2f);
    laser.setScanRangeValidity(i, i == 180);
  }
  EXPECT_EQ(virtual_scan(laser, {.yaws = {0.0}}, "").beams[0].echo, Echo::none);
  laser.setScanRange(180, 0.01f);
  EXPECT_EQ(virtual_scan(laser, {.yaws = {0.0}}, "").beams[0].echo, Echo::saturated);
}

TEST(VirtualRing, IsDeafToASurfaceThatComesNearerOutsideTheCone) {
  auto laser = scanner_before_wall(1.3, kPi);
  VirtualRing ring{.half_angle = radians(10.0), .max_range = 4.0};
  for (const double yaw : {-50.0, -30.0, -10.5, -8.0, 0.0, 8.0, 10.5, 30.0, 50.0}) ring.yaws.push_back(radians(yaw));
  ring.margin = radians(2.0);
  const UltrasonicScan scan = virtual_scan(laser, ring, "here");
  for (std::size_t i = 0; i < ring.yaws.size(); ++i) {
    const bool normal_inside = std::abs(ring.yaws[i]) < ring.half_angle;
    EXPECT_EQ(scan.beams[i].echo, normal_inside ? Echo::hit : Echo::none) << degrees(ring.yaws[i]);
    EXPECT_NEAR(scan.beams[i].range, normal_inside ? 1.3 : 0.0, 1e-5);
  }
  laser.setScanRange(240, 0.8f);  // at 30 degrees, before the wall: nothing nearer beside it
  EXPECT_NEAR(virtual_scan(laser, ring, "here").beams[7].range, 0.8, 1e-6);
  ring.yaws = {radians(79.0)};  // the margin reaches beyond the field
  EXPECT_THROW(static_cast<void>(virtual_scan(laser, ring, "here")), InputError);
  EXPECT_EQ(virtual_scan(laser, {.sensors = 5, .margin = radians(3.0)}, "").beams.size(), 5u);
}

std::string refused(const CObservation2DRangeScan& laser, const VirtualRing& ring) {
  try {
    static_cast<void>(virtual_scan(laser, ring, "log: object 3"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

TEST(VirtualRing, RefusesConesTheScannerCannotFill) {
  auto laser = scanner_before_wall(1.0, kPi);
  EXPECT_EQ(
      refused(laser, {.yaws = {radians(85.0)}, .half_angle = radians(10.0)}),
      "log: object 3: expected cones inside the laser's field of 180.000005 deg, got one about 85.000000 deg with "
      "half angle 10.000000 deg and margin 0.000000 deg");
  EXPECT_NE(refused(laser, {.yaws = {radians(0.25)}, .half_angle = radians(0.1)})
                .find("expected laser beams inside each cone, got 361 in the whole field"),
            std::string::npos);
  EXPECT_NE(refused(CObservation2DRangeScan(), {.sensors = 3}).find("got 0 in the whole field"), std::string::npos);
  laser.sensorPose = mrpt::poses::CPose3D(0, 0, 0, 0, radians(20.0), 0);
  EXPECT_NE(refused(laser, {}).find("log: object 3: expected a level sensor, got pitch 0.349"), std::string::npos);
}

}  // namespace
}  // namespace noctule::datasets
