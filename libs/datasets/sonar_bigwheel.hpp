#pragma once
/// BigFaceRobotics' "Big Wheel Bot" in a garden: wheel encoders, a compass heading, sonars ahead and behind, infrared
/// to the sides (github.com/BigFace83/Big-Wheel-Bot).
#include <filesystem>

#include "core/parameters.hpp"
#include "datasets/recorded_source.hpp"
#include "models/odometry.hpp"

namespace noctule::datasets {

struct SonarBigwheelParameters {
  std::filesystem::path path{};       ///< one Garden_*.txt
  double period = 0.2;                ///< between rows [s]; the files carry no time
  double tick = 0.005;                ///< way of a wheel per encoder tick [m]
  bool clockwise_yaw = true;          ///< the recorded yaw grows clockwise, as its sign against the encoders says
  double half_angle = radians(15.0);  ///< half opening of a sonar's cone [rad]; not documented
  double min_range = 0.05;            ///< [m]
  double front_offset = 0.0;          ///< of the front sonar ahead of the base [m]; not documented
  double rear_offset = 0.0;           ///< of the rear sonar behind the base [m]; not documented
  bool infrared = false;              ///< yield the side rangers too, as scans of their own
  models::OdometryRandomWalk odometry_noise{.along = 0.03, .drift = radians(1.0), .turn = radians(2.0)};

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SonarBigwheelParameters;
    v.field("path", &P::path, unit::one, "one of the files Garden_*.txt");
    v.field("period_s", &P::period, unit::second, "time between two rows", positive());
    v.field("tick_m", &P::tick, unit::metre, "way of a wheel per encoder tick", positive());
    v.field("clockwise_yaw", &P::clockwise_yaw, unit::one, "whether the recorded yaw grows clockwise");
    v.field("half_angle_deg", &P::half_angle, unit::degree, "half the opening of a sonar's cone", positive());
    v.field("min_range_m", &P::min_range, unit::metre, "shorter ranges count as saturated", at_least(0.0));
    v.field("front_offset_m", &P::front_offset, unit::metre, "front sonar ahead of the base", at_least(0.0));
    v.field("rear_offset_m", &P::rear_offset, unit::metre, "rear sonar behind the base", at_least(0.0));
    v.field("infrared", &P::infrared, unit::one, "whether the infrared side rangers are yielded too");
    v.group("odometry_noise", &P::odometry_noise, "stated covariance of the wheel odometry");
  }
};

/// Rows of nine integers: left and right encoder ticks since the row before, yaw [deg], front and rear sonar [cm]
/// (500 or more: no echo), left and right infrared [cm] (60: nothing), two raw values that are not read.
/// Yields from the second row on Odometry (way from the encoders, heading from the yaw), and at each row a scan of
/// (front, rear) and, when asked, a scan of the infrared (left, right). The map frame is the pose of the first row.
/// Garden_04_04_20.txt and Garden_09_04_20.txt have a yaw fault; the reader cannot see it.
class SonarBigwheel : public RecordedSource {
 public:
  /// \throws InputError for a missing or damaged file, another number of columns, what is not an integer, negative
  ///         ranges
  explicit SonarBigwheel(const SonarBigwheelParameters& parameters);
};

}  // namespace noctule::datasets
