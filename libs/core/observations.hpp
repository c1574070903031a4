#pragma once
/// What the robot measures, as values: produced by sim, datasets and the sensors, eaten by filters and mapping.
#include <cstdint>
#include <vector>

#include "core/pose2.hpp"
#include "core/stamp.hpp"

namespace noctule {

/// Motion of the base since the previous odometry of the channel.
struct Odometry {
  Stamp stamp;
  Pose2 increment;                       ///< pose of base_link now in base_link at the previous odometry [m, m, rad]
  Matrix3 covariance = Matrix3::Zero();  ///< of the increment, order (x, y, yaw); may be singular
};

enum class Echo : std::int8_t {
  hit = 0,        ///< `range` is a distance
  none = 1,       ///< nothing heard within the limits; `range` is 0
  saturated = 2,  ///< closer than the sensor can tell; `range` is 0
  invalid = 3     ///< sensor fault, stale or dropped reading; `range` is 0
};

/// One ping. A ranger returns the first echo inside its cone: the distance says nothing about where in the cone.
struct UltrasonicBeam {
  Pose2 sensor_in_base;  ///< emitter at the moment of the ping; yaw is the axis of the cone
  double range = 0.0;    ///< [m], only meaningful for Echo::hit
  Echo echo = Echo::none;
};

/// Pings taken at one stop of the base (a stepper scan) or at one instant (a ring of fixed rangers).
/// The pose of the base is the one at `stamp.utime`.
struct UltrasonicScan {
  Stamp stamp;
  double half_angle = 0.0;  ///< half the opening of the cone [rad]
  double min_range = 0.0;   ///< [m]
  double max_range = 0.0;   ///< [m]
  std::vector<UltrasonicBeam> beams;
};

/// Names one ping for ever: every reading enters a filter exactly once.
struct ReadingId {
  std::int64_t scan_seq = 0;
  std::int32_t beam = 0;
  friend auto operator<=>(const ReadingId&, const ReadingId&) = default;
};

enum class DetectionKind : std::int8_t { range_bearing = 0, bearing_only = 1, range_only = 2 };

/// Sighting of one landmark.
struct LandmarkDetection {
  DetectionKind kind = DetectionKind::range_bearing;
  double range = 0.0;                    ///< [m] from the sensor; 0 for bearing_only
  double bearing = 0.0;                  ///< [rad] from the sensor's x axis, left positive; 0 for range_only
  Matrix2 covariance = Matrix2::Zero();  ///< order (range, bearing); rows of what is not measured are 0
  std::int64_t id = -1;                  ///< identity of the landmark where the sensor knows it, else -1
  double score = 1.0;                    ///< confidence in [0, 1]
};

struct LandmarkDetections {
  Stamp stamp;
  Pose2 sensor_in_base;
  std::vector<LandmarkDetection> detections;
};

struct GroundTruth {
  Stamp stamp;
  Pose2 base_in_map;
};

}  // namespace noctule
