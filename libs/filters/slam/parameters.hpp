#pragma once
/// Parameters of the particle SLAM filters.
#include "core/parameters.hpp"
#include "models/ultrasonic.hpp"
#include "particle/resampling.hpp"

namespace noctule::filters {

/// How one ultrasonic echo is judged.
struct EchoParameters {
  models::RangeNoise range_noise;          ///< Gaussian, all that the filter knows of the noise
  double bearing_sd_per_half_angle = 0.5;  ///< sd of the echo's direction about the axis, in half cones
  double clutter_fraction = 0.02;          ///< echoes that come from no landmark ...
  double clutter_range = 4.0;              ///< ... evenly over so many metres and all directions

  /// Log density of an echo from nowhere, per metre and radian.
  [[nodiscard]] double log_clutter() const { return std::log(clutter_fraction / (clutter_range * kTwoPi)); }

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("range_noise", &EchoParameters::range_noise, "nominal noise of one range");
    v.field("bearing_sd_per_half_angle", &EchoParameters::bearing_sd_per_half_angle, unit::one,
            "sd of an echo's direction about the axis of the cone, in half cones", positive());
    v.field("clutter_fraction", &EchoParameters::clutter_fraction, unit::one, "share of echoes from no landmark",
            Range{.min = 0.0, .max = 1.0, .min_allowed = false});
    v.field("clutter_range_m", &EchoParameters::clutter_range, unit::metre,
            "such echoes lie evenly between 0 and this range", positive());
  }
};

/// Birth, decision and death of walls, cylinders and points heard by ultrasound.
struct ContourLandmarkParameters {
  double separation = 0.15;             ///< surfaces nearer than this to a known one are taken for that one [m]
  double range_sd = 0.10;               ///< prior sd of a new surface along the line of sight [m]
  double direction_sd = radians(15.0);  ///< prior sd of the direction in which it is seen [rad]
  double radius = 0.08;                 ///< prior radius of a circle where the extractor knows none [m]
  double radius_sd = 0.08;              ///< [m]
  double point_radius_sd = 0.01;        ///< prior sd of the radius of what the extractor calls a point [m]
  double decide_log_ratio = 8.0;        ///< wall or circle: needed ratio of their log likelihoods ...
  int decide_stops = 3;                 ///< ... after so many stops
  double stop_distance = 0.05;          ///< a stop is new when so far from the last one [m]
  int trial_stops = 6;                  ///< a landmark of this age [stops] ...
  int confirm_stops = 4;                ///< ... is deleted unless seen from so many of them

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = ContourLandmarkParameters;
    v.field("separation_cm", &P::separation, unit::centimetre,
            "no landmark starts where a known one is expected at a range as near as this", at_least(0.0));
    v.field("range_sd_cm", &P::range_sd, unit::centimetre, "prior sd of a new surface along the line of sight",
            positive());
    v.field("direction_sd_deg", &P::direction_sd, unit::degree, "prior sd of the direction of a new surface",
            positive());
    v.field("radius_cm", &P::radius, unit::centimetre, "prior radius of a new cylinder", at_least(0.0));
    v.field("radius_sd_cm", &P::radius_sd, unit::centimetre, "prior sd of that radius", positive());
    v.field("point_radius_sd_cm", &P::point_radius_sd, unit::centimetre,
            "prior sd of the radius (0) of what the extractor calls a point", positive());
    v.field("decide_log_ratio", &P::decide_log_ratio, unit::one,
            "wall or circle is decided when their log likelihoods differ by this", positive());
    v.field("decide_stops", &P::decide_stops, unit::one, "and so many stops have seen it", at_least(1));
    v.field("stop_distance_cm", &P::stop_distance, unit::centimetre, "way between two stops that count as different",
            positive());
    v.field("trial_stops", &P::trial_stops, unit::one, "at this age a landmark is judged", at_least(1));
    v.field("confirm_stops", &P::confirm_stops, unit::one, "and deleted unless seen from so many stops", at_least(0));
  }
};

/// Sightings of point landmarks whose identity the sensor does not know.
struct SightingParameters {
  double gate = 9.21;         ///< largest squared Mahalanobis distance of a match (99 % for 2 numbers)
  double new_above = 25.0;    ///< a sighting farther than this from all landmarks starts one; between: dropped
  double new_density = 0.01;  ///< density of sightings of unmapped landmarks, per metre of range and radian

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SightingParameters;
    v.field("gate", &P::gate, unit::one, "largest squared Mahalanobis distance of a match", positive());
    v.field("new_above", &P::new_above, unit::one, "a sighting farther than this from all landmarks is a new one",
            positive());
    v.field("new_density", &P::new_density, unit::one, "density of sightings of unmapped landmarks, per m and rad",
            positive());
  }

  [[nodiscard]] std::string validate() const {
    return new_above < gate ? "new_above must not be below gate" : std::string();
  }
};

struct ParticleSlamParameters {
  int particles = 100;
  particle::Resampling resampling = particle::Resampling::systematic;
  double resample_below = 0.5;  ///< resample when the effective sample size falls below this share of the particles
  EchoParameters echo;
  ContourLandmarkParameters contour_landmarks;
  SightingParameters sightings;
  /// Most threads to use; no result depends on it. Not listed below: it belongs to the machine, not to the filter.
  int threads = 1;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = ParticleSlamParameters;
    v.field("particles", &P::particles, unit::one, "number of particles", Range{.min = 1, .max = 10'000'000});
    v.choice("resampling", &P::resampling, particle::resampling_choices(), "how particles are redrawn");
    v.field("resample_below", &P::resample_below, unit::one,
            "resample when the effective sample size is below this share of the particles", between(0.0, 1.0));
    v.group("echo", &P::echo, "how one ultrasonic echo is judged");
    v.group("contour_landmarks", &P::contour_landmarks, "walls, cylinders and points heard by ultrasound");
    v.group("sightings", &P::sightings, "sightings of point landmarks of unknown identity");
  }
};

}  // namespace noctule::filters
