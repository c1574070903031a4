#pragma once
#include "core/parameters.hpp"
#include "mapping/echo_fit.hpp"
#include "mapping/hough_votes.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::mapping {

/// What must support an object before it is believed.
struct SupportParameters {
  int min_readings = 20;
  int min_stops = 6;
  double min_span = 0.30;          ///< of the wall seen, or between sensor positions for a cylinder or a point [m]
  double min_gain = 60.0;          ///< log likelihood ratio against all other explanations
  double max_contradiction = 0.5;  ///< echoes heard from behind it, per echo it explains
  double min_radius = 0.04;        ///< [m]; smaller cylinders are points
  double radius_evidence = 20.0;   ///< log likelihood ratio against a point that a radius needs
  double merge_distance = 0.20;    ///< of parallel walls, one before the other: they are one [m]
  double merge_angle = radians(10.0);

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("min_readings", &SupportParameters::min_readings, unit::one, "echoes an object must explain", at_least(3));
    v.field("min_stops", &SupportParameters::min_stops, unit::one, "sensor positions it must be heard from",
            at_least(2));
    v.field("min_span_cm", &SupportParameters::min_span, unit::centimetre,
            "length of a wall seen, or distance between sensor positions for a cylinder or a point", positive());
    v.field("min_gain", &SupportParameters::min_gain, unit::one, "log likelihood ratio against all other explanations",
            positive());
    v.field("max_contradiction", &SupportParameters::max_contradiction, unit::one,
            "echoes heard from behind an object, per echo that it explains", positive());
    v.field("min_radius_cm", &SupportParameters::min_radius, unit::centimetre, "smaller cylinders are points",
            positive());
    v.field("radius_evidence", &SupportParameters::radius_evidence, unit::one,
            "log likelihood ratio against a point that a cylinder needs", at_least(0.0));
    v.field("merge_distance_cm", &SupportParameters::merge_distance, unit::centimetre,
            "walls one before the other, closer than this, are one", at_least(0.0));
    v.field("merge_angle_deg", &SupportParameters::merge_angle, unit::degree, "and nearer to parallel than this",
            between(0.0, 45.0));
  }
};

struct MapperParameters {
  models::RangeNoise range_noise;
  double clutter = 0.05;        ///< share of echoes that come from nothing on the map
  double clutter_range = 4.0;   ///< over which they are spread evenly [m]
  double stop_distance = 0.05;  ///< between stops [m]
  HoughParameters hough;
  RobustParameters robust;
  SupportParameters support;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("range_noise", &MapperParameters::range_noise, "nominal noise of a range");
    v.field("clutter", &MapperParameters::clutter, unit::one, "share of echoes that come from nothing on the map",
            between(1e-6, 0.9));
    v.field("clutter_range_m", &MapperParameters::clutter_range, unit::metre, "over which they are spread evenly",
            positive());
    v.field("stop_distance_cm", &MapperParameters::stop_distance, unit::centimetre,
            "scans nearer to each other count as one stop", at_least(0.0));
    v.group("hough", &MapperParameters::hough, "resolution of the accumulators");
    v.group("robust", &MapperParameters::robust, "outliers");
    v.group("support", &MapperParameters::support, "evidence an object needs");
  }
};

}  // namespace noctule::mapping
