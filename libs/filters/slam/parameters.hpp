#pragma once
/// Parameters of the particle SLAM filters.
#include "core/parameters.hpp"
#include "filters/noise/parameters.hpp"
#include "models/ultrasonic.hpp"
#include "particle/resampling.hpp"

namespace noctule::filters {

/// How one ultrasonic echo is judged.
struct EchoParameters {
  models::RangeNoise range_noise;          ///< nominal: the Gaussian that `noise` is in units of
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

enum class Matching : std::int8_t {
  likelihood,  ///< all sightings of a message at once, each landmark at most once: the most likely assignment
  nearest,     ///< each sighting for itself, to the landmark that makes it most likely
  joint        ///< the largest set that is compatible together (EKF-SLAM only: given its path, a particle's landmarks
               ///< are independent, and nothing is to be gained)
};

/// How sightings of bearing or range alone begin landmarks: a track collects them until they fix a place.
struct LandmarkTrackParameters {
  double certain = 0.1;      ///< the sd of the place in its worst direction is below this share of its distance
  double max_range = 50.0;   ///< farthest landmark begun [m]
  double spacing = 0.2;      ///< way of the sensor between two sightings that are kept [m]
  int sightings = 16;        ///< most sightings kept; then the way between them is doubled
  int forget_after = 40;     ///< messages without a sighting after which a track without identity ends
  double agreement = 0.999;  ///< a track whose sightings disagree beyond this chi-square quantile is given up

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkTrackParameters;
    v.field("certain", &P::certain, unit::one,
            "a landmark is begun when the sd of its place is below this share of its distance",
            Range{.min = 0.0, .max = 0.5, .min_allowed = false});
    v.field("max_range_m", &P::max_range, unit::metre, "farthest landmark begun", positive());
    v.field("spacing_m", &P::spacing, unit::metre, "way of the sensor between two sightings that are kept", positive());
    v.field("sightings", &P::sightings, unit::one, "most sightings kept; then the way between them is doubled",
            Range{.min = 4, .max = 64});
    v.field("forget_after", &P::forget_after, unit::one,
            "messages without a sighting after which a track of unknown identity ends", at_least(1));
    v.field("agreement", &P::agreement, unit::one,
            "a track is given up whose sightings disagree beyond this quantile of chi-square",
            Range{.min = 0.5, .max = 1.0, .max_allowed = false});
  }
};

/// Sightings of point landmarks whose identity the sensor does not know.
struct SightingParameters {
  Matching match = Matching::likelihood;
  double gate = 9.21;         ///< largest squared Mahalanobis distance of a match (99 % for 2 numbers)
  double new_above = 25.0;    ///< a sighting farther than this from all landmarks starts one; between: dropped
  double new_density = 0.01;  ///< density of sightings of unmapped landmarks, per metre of range and radian
  double named_gate = 0.0;    ///< the gate of sightings whose identity is known; 0: none
  LandmarkTrackParameters tracks;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SightingParameters;
    v.choice("match", &P::match,
             Choices<Matching>{
                 {"likelihood", Matching::likelihood}, {"nearest", Matching::nearest}, {"joint", Matching::joint}},
             "how sightings find their landmarks; joint: EKF-SLAM only");
    v.field("gate", &P::gate, unit::one, "largest squared Mahalanobis distance of a match", positive());
    v.field("new_above", &P::new_above, unit::one, "a sighting farther than this from all landmarks is a new one",
            positive());
    v.field("new_density", &P::new_density, unit::one, "density of sightings of unmapped landmarks, per m and rad",
            positive());
    v.field("named_gate", &P::named_gate, unit::one,
            "sightings of known identity beyond this squared Mahalanobis distance are dropped; 0: none", at_least(0.0));
    v.group("tracks", &P::tracks, "landmarks begun by sightings of bearing or range alone");
  }

  [[nodiscard]] std::string validate() const {
    return new_above < gate ? "new_above must not be below gate" : std::string();
  }
};

/// Offspring drawn with weights psi_i = (1 - 1/K) w_i + 1/(K N) instead of w_i (Wang, Wang 2022, eq. 7).
struct OffspringTempering {
  double k = 0.0;          ///< K >= 1; 0: offspring are drawn with the weights themselves
  bool corrected = false;  ///< gives offspring the weight w_i / psi_i, which keeps the filter unbiased
  double movement = 0.0;   ///< copies are moved at random by this fraction of the particles' spread in x and y ...
  double rotation = 0.0;   ///< ... and yaw

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = OffspringTempering;
    v.field("k", &P::k, unit::one, "K of eq. 7, 1 (uniform) and up; 0: the weights themselves", at_least(0.0));
    v.field("corrected", &P::corrected, "weigh offspring by w / psi, which keeps the filter unbiased");
    v.field("movement", &P::movement, unit::one, "copies are moved by this fraction of the spread in x and y",
            at_least(0.0));
    v.field("rotation", &P::rotation, unit::one, "and turned by this fraction of the spread in yaw", at_least(0.0));
  }
  [[nodiscard]] std::string validate() const {
    return k > 0.0 && k < 1.0 ? "k: expected 0 or a number >= 1" : std::string();
  }
};

/// The fields that all particle filters have.
template <class P, class Visitor>
void describe_particles(Visitor& v) {
  v.field("particles", &P::particles, unit::one, "number of particles", Range{.min = 1, .max = 10'000'000});
  v.choice("resampling", &P::resampling, particle::resampling_choices(), "how particles are redrawn");
  v.field("resample_below", &P::resample_below, unit::one,
          "resample when the effective sample size is below this share of the particles", between(0.0, 1.0));
}

/// Where particles are drawn that hear a scan.
enum class EchoProposal : std::int8_t {
  motion,  ///< from odometry alone (FastSLAM 1)
  echoes   ///< from odometry and the scan, given each particle's map (FastSLAM 2)
};

/// What path() and map() say.
enum class SmoothPath {
  none,  ///< the best particle's
  all    ///< the most likely path and map given everything up to now, found from the best particle's
};

struct PathSmootherParameters {
  /// A motion between two observations is taken to err by these standard deviations too, independently: covariances of
  /// odometry are singular, of a robot at rest 0.
  double position_floor = 1e-4;  ///< [m]
  double heading_floor = 1e-5;   ///< [rad]
  int max_iterations = 50;
  double tolerance = 1e-3;  ///< converged when a step raises the log likelihood by less than this

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = PathSmootherParameters;
    v.field("position_floor_cm", &P::position_floor, unit::centimetre,
            "sd added to each motion between observations, so that a singular covariance has a density", positive());
    v.field("heading_floor_deg", &P::heading_floor, unit::degree, "the same of the heading", positive());
    v.field("max_iterations", &P::max_iterations, unit::one, "most iterations", at_least(1));
    v.field("tolerance", &P::tolerance, unit::one, "least gain of an iteration in log likelihood", positive());
  }
};

struct ParticleSlamParameters {
  int particles = 100;
  particle::Resampling resampling = particle::Resampling::systematic;
  double resample_below = 0.5;  ///< resample when the effective sample size falls below this share of the particles
  EchoProposal proposal = EchoProposal::motion;
  NoiseParameters noise;  ///< of echo ranges; one for all rangers
  EchoParameters echo;
  ContourLandmarkParameters contour_landmarks;
  SightingParameters sightings;
  SmoothPath smooth_path = SmoothPath::none;
  PathSmootherParameters path_smoother;
  /// Most threads to use; no result depends on it. Not listed below: it belongs to the machine, not to the filter.
  int threads = 1;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = ParticleSlamParameters;
    describe_particles<P>(v);
    v.choice("proposal", &P::proposal,
             Choices<EchoProposal>{{"motion", EchoProposal::motion}, {"echoes", EchoProposal::echoes}},
             "particles that hear a scan are drawn from odometry alone, or from odometry and the scan");
    v.one_of("noise", &P::noise, {"fixed", "em", "vb"}, "noise of echo ranges: nominal, or learned on the way");
    v.group("echo", &P::echo, "how one ultrasonic echo is judged");
    v.group("contour_landmarks", &P::contour_landmarks, "walls, cylinders and points heard by ultrasound");
    v.group("sightings", &P::sightings, "sightings of point landmarks of unknown identity");
    v.choice("smooth_path", &P::smooth_path, Choices<SmoothPath>{{"none", SmoothPath::none}, {"all", SmoothPath::all}},
             "path and map: of the best particle, or smoothed over all observations");
    v.group("path_smoother", &P::path_smoother, "how they are smoothed");
  }
};

/// The same filter under the names that comparisons know: noise learned from the start unless told otherwise.
struct VbParticleSlamParameters : ParticleSlamParameters {
  VbParticleSlamParameters() { noise = VbNoiseParameters{}; }
};
struct EmParticleSlamParameters : ParticleSlamParameters {
  EmParticleSlamParameters() { noise = EmNoiseParameters{}; }
};

}  // namespace noctule::filters
