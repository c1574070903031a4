#pragma once
#include "core/parameters.hpp"
#include "mapping/echo_model.hpp"
#include "mapping/hough_votes.hpp"
#include "mapping/single_stop.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::mapping {

/// What must speak for an object before it is believed.
struct SupportParameters {
  int min_readings = 14;        ///< echoes of a wall
  int min_round_readings = 20;  ///< echoes of a cylinder or a point
  int min_stops = 6;
  double min_span = 0.30;          ///< of the wall seen, or between sensor positions for a cylinder or a point [m]
  double min_gain = 60.0;          ///< log likelihood ratio against all other explanations
  double max_contradiction = 0.5;  ///< echoes heard from behind it, per echo it explains
  double min_radius = 0.04;        ///< smaller cylinders are points [m]
  double radius_evidence = 20.0;   ///< log likelihood ratio that a cylinder needs against a point and a wall
  double merge_distance = 0.30;    ///< walls one before the other, closer than this, are one [m]
  double merge_angle = radians(15.0);

  /// Least number of echoes of an object.
  [[nodiscard]] int enough(bool is_wall) const { return is_wall ? min_readings : min_round_readings; }

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("min_readings", &SupportParameters::min_readings, unit::one, "echoes a wall must explain", at_least(3));
    v.field("min_round_readings", &SupportParameters::min_round_readings, unit::one,
            "echoes a cylinder or a point must explain", at_least(3));
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
            "log likelihood ratio that a cylinder needs against a point and a wall", at_least(0.0));
    v.field("merge_distance_cm", &SupportParameters::merge_distance, unit::centimetre,
            "walls one before the other, closer than this, are one", at_least(0.0));
    v.field("merge_angle_deg", &SupportParameters::merge_angle, unit::degree, "and nearer to parallel than this",
            between(0.0, 45.0));
  }
};

struct MapperParameters {
  models::RangeNoise range_noise;
  double max_noise_scale = 10.0;  ///< largest believed range noise, in nominal standard deviations
  double stop_distance = 0.05;    ///< scans nearer to each other count as one stop [m]
  double max_extent = 25.0;       ///< the accumulators cover at most this far around the start [m]
  int max_arcs = 6000;            ///< echoes that ContourMapper keeps at most
  EchoModelParameters echo;
  HoughParameters hough;
  RobustParameters robust;
  SupportParameters support;
  SingleStopParameters single_stop;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("range_noise", &MapperParameters::range_noise, "nominal noise of a range");
    v.field("max_noise_scale", &MapperParameters::max_noise_scale, unit::one,
            "largest believed range noise, in nominal standard deviations", at_least(1.0));
    v.field("stop_distance_cm", &MapperParameters::stop_distance, unit::centimetre,
            "scans nearer to each other count as one stop", at_least(0.0));
    v.field("max_extent_m", &MapperParameters::max_extent, unit::metre,
            "how far around the start the map reaches at most", positive());
    v.field("max_arcs", &MapperParameters::max_arcs, unit::one, "echoes that the incremental mapper keeps at most",
            at_least(100));
    v.group("echo", &MapperParameters::echo, "where echoes come from");
    v.group("hough", &MapperParameters::hough, "resolution of the accumulators");
    v.group("robust", &MapperParameters::robust, "outliers");
    v.group("support", &MapperParameters::support, "evidence an object needs");
    v.group("single_stop", &MapperParameters::single_stop, "walls from one place alone; final map only");
  }
};

}  // namespace noctule::mapping
