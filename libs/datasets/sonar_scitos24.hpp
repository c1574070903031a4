#pragma once
/// The ring of 24 sonars of a SCITOS G5 that follows the walls of a room (A. Freire, G. Barreto, M. Veloso, A. Varela,
/// "Short-term memory mechanisms in neural network learning of robot navigation tasks", LARS 2009; UCI repository
/// "Wall-Following Robot Navigation Data").
#include <filesystem>

#include "core/parameters.hpp"
#include "datasets/recorded_source.hpp"

namespace noctule::datasets {

struct SonarScitos24Parameters {
  std::filesystem::path path{};       ///< sensor_readings_24.data
  double rate = 9.0;                  ///< rows per second [Hz]; the file carries no time
  double half_angle = radians(15.0);  ///< half opening of a sonar's cone [rad]; not documented
  double ring_radius = 0.0;           ///< of the sonars about the robot's centre [m]; not documented
  double min_range = 0.2;             ///< [m]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SonarScitos24Parameters;
    v.field("path", &P::path, unit::one, "file sensor_readings_24.data");
    v.field("rate_hz", &P::rate, unit::hertz, "rows per second", positive());
    v.field("half_angle_deg", &P::half_angle, unit::degree, "half the opening of a sonar's cone", positive());
    v.field("ring_radius_m", &P::ring_radius, unit::metre, "distance of the sonars from the robot's centre",
            at_least(0.0));
    v.field("min_range_m", &P::min_range, unit::metre, "shorter ranges count as saturated", at_least(0.0));
  }
};

/// A header, then rows of S1..S24 [m] (5.0 or more: no echo) and the name of the motion command, which is not read.
/// S1 looks ahead, the others follow clockwise every 15 degrees. Yields scans only: the recording has no odometry and
/// no pose, so it serves for the statistics of a ring and not for a map.
class SonarScitos24 : public RecordedSource {
 public:
  /// \throws InputError for a missing or damaged file, another header, negative ranges
  explicit SonarScitos24(const SonarScitos24Parameters& parameters);
};

}  // namespace noctule::datasets
