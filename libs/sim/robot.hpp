#pragma once
/// What a simulated robot is made of: its drive, its odometry, its ultrasonic rangers and its camera.
#include <optional>
#include <string>
#include <vector>

#include "core/parameters.hpp"
#include "core/pose2.hpp"
#include "models/noise_schedule.hpp"
#include "models/odometry.hpp"
#include "models/ultrasonic.hpp"
#include "sim/camera_parameters.hpp"

namespace noctule::sim {

enum class DriveModel {
  turn_and_go,  ///< turns on the spot, then goes straight
  front_axle    ///< steered front wheels (Yuan et al., eq. 13); base_link is the centre of the front axle
};

struct DriveParameters {
  DriveModel model = DriveModel::turn_and_go;
  double speed = 0.2;
  double turn_rate = radians(90);
  double odometry_rate = 10.0;
  double wheelbase = 0.12;
  double max_steering = radians(30);
  double steering_rate = radians(90);
  double waypoint_radius = 0.1;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.choice("model", &DriveParameters::model,
             {{"turn_and_go", DriveModel::turn_and_go}, {"front_axle", DriveModel::front_axle}},
             "turn_and_go: turns on the spot, then straight; front_axle: steered front wheels");
    v.field("speed_m_per_s", &DriveParameters::speed, unit::metre_per_second, "speed on the way", at_least(0.001));
    v.field("turn_rate_deg_per_s", &DriveParameters::turn_rate, unit::degree_per_second,
            "turn_and_go: rate of turns on the spot", at_least(0.1));
    v.field("odometry_rate_hz", &DriveParameters::odometry_rate, unit::hertz,
            "least rate of odometry while moving; front_axle: also of the steering", between(0.1, 1000.0));
    v.field("wheelbase_cm", &DriveParameters::wheelbase, unit::centimetre, "front_axle: distance of the axles",
            positive());
    v.field("max_steering_deg", &DriveParameters::max_steering, unit::degree, "front_axle: largest steering angle",
            Range{.min = 0.0, .max = 90.0, .min_allowed = false, .max_allowed = false});
    v.field("steering_rate_deg_per_s", &DriveParameters::steering_rate, unit::degree_per_second,
            "front_axle: rate at which the wheels are turned", positive());
    v.field("waypoint_radius_cm", &DriveParameters::waypoint_radius, unit::centimetre,
            "front_axle: distance from which on a way-point counts as reached", positive());
  }
};

enum class Mounting {
  stepper,  ///< one ranger turned by a stepper motor
  fixed     ///< several rangers fixed to the base
};
enum class Firing {
  one_by_one,  ///< each ping waits for its own echo
  parallel     ///< all at once: each ranger may hear the others
};

struct StepperParameters {
  Pose2 mount;
  int pings = 60;
  double step = radians(6);

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("mount_cm_deg", &StepperParameters::mount, unit::centimetre_degree,
            "pose of the ranger on the base at the first ping");
    v.field("pings", &StepperParameters::pings, unit::one, "pings of one scan", between(1, 10000));
    v.field("step_deg", &StepperParameters::step, unit::degree, "turn of the ranger from ping to ping");
  }
};

struct MountParameters {
  Pose2 pose;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("at_cm_deg", &MountParameters::pose, unit::centimetre_degree, "pose of the ranger on the base");
  }
};

/// Part of the range noise: with probability `weight` its standard deviation is `factor` times the nominal one.
struct NoiseComponent {
  double weight = 1.0;
  double factor = 1.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("weight", &NoiseComponent::weight, unit::one, "probability", between(0.0, 1.0));
    v.field("factor", &NoiseComponent::factor, unit::one, "standard deviation in units of the nominal one",
            at_least(0.0));
  }
};

/// How likely an echo is heard: peak exp(-falloff (a / half_angle)^2) (1 - (r / max_range)^4), a the angle between the
/// axis of the cone and the echo. Edges that jut into the room diffract and have a peak of their own.
struct HitParameters {
  double peak = 0.98;
  double edge_peak = 0.3;
  double falloff = 2.0;
  bool fades_with_range = true;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("peak", &HitParameters::peak, unit::one, "probability on the axis, nearby", between(0.0, 1.0));
    v.field("edge_peak", &HitParameters::edge_peak, unit::one, "the same for an edge", between(0.0, 1.0));
    v.field("falloff", &HitParameters::falloff, unit::one, "loss towards the border of the cone", at_least(0.0));
    v.field("fades_with_range", &HitParameters::fades_with_range, "whether the probability falls to 0 at max_range");
  }
};

/// An HC-SR04 or the like.
struct SonarParameters {
  Mounting mounting = Mounting::stepper;
  StepperParameters stepper;
  std::vector<MountParameters> mounts;
  Firing firing = Firing::one_by_one;
  double ping_period = 0.06;
  double half_angle = radians(15);
  double min_range = 0.02;
  double max_range = 4.0;
  HitParameters hit;
  models::RangeNoise noise;
  std::vector<NoiseComponent> mixture;
  std::vector<models::NoiseStage> schedule;
  double outliers = 0.0;
  double quantisation = 0.003;
  double scale_error = 0.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.choice("mounting", &SonarParameters::mounting, {{"stepper", Mounting::stepper}, {"fixed", Mounting::fixed}},
             "stepper: one ranger turned by a motor; fixed: several, see mounts");
    v.group("stepper", &SonarParameters::stepper, "the turning ranger");
    v.list("mounts", &SonarParameters::mounts, "the fixed rangers");
    v.choice("firing", &SonarParameters::firing, {{"one_by_one", Firing::one_by_one}, {"parallel", Firing::parallel}},
             "of fixed rangers; parallel: each may hear the echoes of the others");
    v.field("ping_period_s", &SonarParameters::ping_period, unit::second, "time of one ping", positive());
    v.field("half_angle_deg", &SonarParameters::half_angle, unit::degree, "half the opening of the cone",
            Range{.min = 0.0, .max = 90.0, .min_allowed = false, .max_allowed = false});
    v.field("min_range_cm", &SonarParameters::min_range, unit::centimetre, "nearest distance told", at_least(0.0));
    v.field("max_range_cm", &SonarParameters::max_range, unit::centimetre, "farthest distance told", positive());
    v.group("hit", &SonarParameters::hit, "how likely an echo is heard");
    v.group("noise", &SonarParameters::noise, "nominal standard deviation s(r) of a range");
    v.list("mixture", &SonarParameters::mixture, "parts of the noise, each normal; none: normal with s(r)");
    v.list("schedule", &SonarParameters::schedule, "change of the noise in time; none: nominal all the time");
    v.field("outliers", &SonarParameters::outliers, unit::one,
            "fraction of echoes that are wrong: half short (cross-talk), half twice the range (multi-bounce)",
            between(0.0, 1.0));
    v.field("quantisation_cm", &SonarParameters::quantisation, unit::centimetre, "ranges are multiples of this; 0: not",
            at_least(0.0));
    v.field("scale_error", &SonarParameters::scale_error, unit::one,
            "ranges are too long by this fraction (speed of sound)",
            Range{.min = -1.0, .max = 1.0, .min_allowed = false, .max_allowed = false});
  }
  /// Empty when the fields fit together.
  [[nodiscard]] std::string validate() const;

  /// Poses of the rangers on the base in the order in which they ping, at the moment of the ping.
  [[nodiscard]] std::vector<Pose2> beams() const;
  /// Time of one scan [s].
  [[nodiscard]] double scan_duration() const;
};

struct RobotParameters {
  std::string name = "unnamed";
  double radius = 0.08;
  DriveParameters drive;
  models::OdometryNoise odometry;
  SonarParameters sonar;
  std::optional<CameraParameters> camera;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &RobotParameters::name, "name in reports");
    v.field("radius_cm", &RobotParameters::radius, unit::centimetre, "of the base, for drawings", positive());
    v.group("drive", &RobotParameters::drive, "how it moves");
    v.group("odometry", &RobotParameters::odometry, "noise of the wheel odometry");
    v.group("sonar", &RobotParameters::sonar, "ultrasonic rangers");
    v.group("camera", &RobotParameters::camera, "absent: none");
  }
};

}  // namespace noctule::sim
