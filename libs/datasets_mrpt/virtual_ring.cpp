#include "datasets_mrpt/virtual_ring.hpp"

#include <mrpt/obs/CObservation2DRangeScan.h>

#include <algorithm>
#include <cmath>

#include "datasets/echo.hpp"
#include "datasets_mrpt/convert.hpp"

namespace noctule::datasets {
namespace {

constexpr double kRounding = 1e-6;  // [rad] apertures are single precision

// Axes of the cones in the frame of the scanner.
std::vector<double> axes(const VirtualRing& ring, double aperture, double scanner_yaw) {
  std::vector<double> axes;
  if (!ring.yaws.empty()) {
    for (const double yaw : ring.yaws) axes.push_back(wrap(yaw - scanner_yaw));
    return axes;
  }
  const double span = aperture - 2.0 * (ring.half_angle + ring.margin);  // from the first axis to the last
  for (int i = 0; i < ring.sensors; ++i) {
    axes.push_back(ring.sensors == 1 ? 0.0 : span * (static_cast<double>(i) / (ring.sensors - 1) - 0.5));
  }
  return axes;
}

struct Cone {
  int laser_beams = 0;
  double nearest = kNoEcho;
  double nearest_beside = kNoEcho;  // within the margin
  [[nodiscard]] double heard() const { return nearest_beside < nearest ? kNoEcho : nearest; }
};

Cone listen(const mrpt::obs::CObservation2DRangeScan& laser, double axis, const VirtualRing& ring) {
  const std::size_t n = laser.getScanSize();
  const double first = (laser.rightToLeft ? -0.5 : 0.5) * laser.aperture;
  const double step = (laser.rightToLeft ? 1.0 : -1.0) * laser.aperture / static_cast<double>(n - 1);
  Cone cone;
  for (std::size_t i = 0; i < n; ++i) {
    const double off_axis = std::abs(first + step * static_cast<double>(i) - axis) - kRounding;
    if (off_axis > ring.half_angle + ring.margin) continue;
    const bool inside = off_axis <= ring.half_angle;
    if (inside) ++cone.laser_beams;
    const double range = laser.getScanRange(i);
    if (!laser.getScanRangeValidity(i) || !std::isfinite(range)) continue;
    double& nearest = inside ? cone.nearest : cone.nearest_beside;
    nearest = std::min(nearest, range);
  }
  return cone;
}

}  // namespace

UltrasonicScan virtual_scan(const mrpt::obs::CObservation2DRangeScan& laser, const VirtualRing& ring,
                            const std::string& place) {
  const Pose2 scanner = to_level_pose(laser.sensorPose, place);
  UltrasonicScan scan{{}, ring.half_angle, ring.min_range, ring.max_range, {}};
  for (const double axis : axes(ring, laser.aperture, scanner.yaw)) {
    const auto refuse = [&](const std::string& expected, const std::string& got) {
      return InputError(place + ": expected " + expected + ", got " + got);
    };
    if (std::abs(axis) + ring.half_angle + ring.margin > 0.5 * laser.aperture + kRounding) {
      throw refuse("cones inside the laser's field of " + std::to_string(degrees(laser.aperture)) + " deg",
                   "one about " + std::to_string(degrees(axis)) + " deg with half angle " +
                       std::to_string(degrees(ring.half_angle)) + " deg and margin " +
                       std::to_string(degrees(ring.margin)) + " deg");
    }
    const Cone cone = laser.getScanSize() < 2 ? Cone{} : listen(laser, axis, ring);
    if (cone.laser_beams == 0) {
      throw refuse("laser beams inside each cone", std::to_string(laser.getScanSize()) + " in the whole field");
    }
    scan.beams.push_back(beam(scanner * Pose2{0.0, 0.0, axis}, cone.heard(), scan));
  }
  return scan;
}

}  // namespace noctule::datasets
