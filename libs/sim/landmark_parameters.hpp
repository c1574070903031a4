#pragma once
/// What a world of point landmarks is made of: places, a steered vehicle, a sensor of range and bearing.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/observations.hpp"
#include "core/parameters.hpp"
#include "core/pose2.hpp"
#include "models/noise_schedule.hpp"

namespace noctule::sim {

/// Places spread evenly over a rectangle.
struct ScatterParameters {
  int count = 0;
  std::uint64_t seed = 1;  ///< of these places alone, not of a run
  Vector2 low = Vector2::Zero();
  Vector2 high = Vector2::Zero();

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("count", &ScatterParameters::count, unit::one, "number of landmarks", between(1, 100000));
    v.field("seed", &ScatterParameters::seed, "of their places; the same in every run");
    v.field("low_m", &ScatterParameters::low, unit::metre, "lower left corner of the rectangle");
    v.field("high_m", &ScatterParameters::high, unit::metre, "upper right corner");
  }
  [[nodiscard]] std::string validate() const;
};

/// Landmarks and the way among them. Landmarks are those listed, then those of the file, then the scattered ones; their
/// ids count from 0 in that order.
struct LandmarkMapParameters {
  std::string name = "unnamed";
  Pose2 start;
  std::vector<Vector2> waypoints;
  std::filesystem::path waypoint_file;
  std::vector<Vector2> landmarks;
  std::filesystem::path landmark_file;
  std::optional<ScatterParameters> scatter;
  double scale = 1.0;
  int loops = 1;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkMapParameters;
    v.field("name", &P::name, "name in reports");
    v.field("start_m_deg", &P::start, unit::metre_degree, "first pose; filters start here");
    v.field("waypoints_m", &P::waypoints, unit::metre, "places to drive to, in order; or give waypoint_file instead");
    v.field("waypoint_file", &P::waypoint_file, "a map of Tim Bailey's simulator, of which the block wp is read");
    v.field("landmarks_m", &P::landmarks, unit::metre, "places of landmarks");
    v.field("landmark_file", &P::landmark_file, "the same, of which the block lm is read: more landmarks");
    v.group("scatter", &P::scatter, "more landmarks, at random");
    v.field("scale", &P::scale, unit::one, "of all these places", positive());
    v.field("loops", &P::loops, unit::one, "times the way-points are visited", at_least(1));
  }
};

/// A vehicle steered by its front wheels; base_link is the centre of the front axle (models::predict_front_axle). The
/// defaults are those of Tim Bailey's simulator (OpenSLAM, 2004).
struct SteeredVehicleParameters {
  double speed = 3.0;
  double wheelbase = 4.0;
  double max_steering = radians(30);
  double steering_rate = radians(20);
  double waypoint_radius = 1.0;
  double control_rate = 40.0;
  double speed_sd = 0.3;            ///< of the speed that odometry is made of [m/s]
  double steering_sd = radians(3);  ///< likewise of the steering angle [rad]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SteeredVehicleParameters;
    v.field("speed_m_per_s", &P::speed, unit::metre_per_second, "speed of the front axle", at_least(0.001));
    v.field("wheelbase_m", &P::wheelbase, unit::metre, "distance of the axles", positive());
    v.field("max_steering_deg", &P::max_steering, unit::degree, "largest steering angle",
            Range{.min = 0.0, .max = 90.0, .min_allowed = false, .max_allowed = false});
    v.field("steering_rate_deg_per_s", &P::steering_rate, unit::degree_per_second, "rate at which the wheels turn",
            positive());
    v.field("waypoint_radius_m", &P::waypoint_radius, unit::metre, "distance from which on a way-point is reached",
            positive());
    v.field("control_rate_hz", &P::control_rate, unit::hertz, "rate of steering and odometry", between(0.1, 1000.0));
    v.field("speed_sd_m_per_s", &P::speed_sd, unit::metre_per_second, "error of the speed in one odometry",
            at_least(0.0));
    v.field("steering_sd_deg", &P::steering_sd, unit::degree, "error of the steering angle in one odometry",
            at_least(0.0));
  }
};

/// Sees all landmarks in the half disc ahead of the vehicle. Sightings state the nominal noise, whatever the schedule.
struct LandmarkSensorParameters {
  double max_range = 30.0;
  int controls_per_scan = 8;
  double range_sd = 0.1;
  double bearing_sd = radians(1);
  std::vector<models::NoiseStage> schedule;
  double outliers = 0.0;
  double outlier_factor = 5.0;
  double clutter = 0.0;
  bool known_ids = true;
  DetectionKind kind = DetectionKind::range_bearing;
  double whole = 0.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkSensorParameters;
    v.field("max_range_m", &P::max_range, unit::metre, "farthest landmark seen", positive());
    v.field("controls_per_scan", &P::controls_per_scan, unit::one, "odometries from one scan to the next", at_least(1));
    v.field("range_sd_m", &P::range_sd, unit::metre, "nominal error of a range", positive());
    v.field("bearing_sd_deg", &P::bearing_sd, unit::degree, "nominal error of a bearing", positive());
    v.list("schedule", &P::schedule, "change of the noise in time; none: nominal all the time");
    v.field("outliers", &P::outliers, unit::one, "share of sightings with a larger error", between(0.0, 1.0));
    v.field("outlier_factor", &P::outlier_factor, unit::one, "standard deviation of those in units of the others'",
            positive());
    v.field("clutter", &P::clutter, unit::one, "mean number of sightings of nothing in one scan", between(0.0, 1000.0));
    v.field("known_ids", &P::known_ids, "whether sightings carry the landmark's number");
    v.choice("kind", &P::kind,
             Choices<DetectionKind>{{"range_bearing", DetectionKind::range_bearing},
                                    {"bearing_only", DetectionKind::bearing_only},
                                    {"range_only", DetectionKind::range_only}},
             "what sightings measure");
    v.field("whole", &P::whole, unit::one, "share of sightings that measure range and bearing whatever the kind",
            between(0.0, 1.0));
  }
  /// Empty when the stages follow each other in time.
  [[nodiscard]] std::string validate() const;
};

struct LandmarkWorldParameters {
  LandmarkMapParameters world;
  SteeredVehicleParameters vehicle;
  LandmarkSensorParameters sensor;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("world", &LandmarkWorldParameters::world, "landmarks and way");
    v.group("vehicle", &LandmarkWorldParameters::vehicle, "a vehicle with steered front wheels");
    v.group("sensor", &LandmarkWorldParameters::sensor, "sightings of landmarks ahead");
  }
};

}  // namespace noctule::sim
