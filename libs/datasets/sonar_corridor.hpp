#pragma once
/// The 8-sonar robot in an L-shaped corridor, as recorded for the occupancy-grid quiz of Udacity's RoboND course
/// (github.com/udacity/RoboND-OccupancyGridMappingAlgorithm).
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/parameters.hpp"
#include "datasets/recorded_source.hpp"

namespace noctule::datasets {

/// How the sd of the added noise follows the length of an increment.
enum class NoiseGrowth : std::int8_t {
  increment = 0,  ///< in proportion to each increment's length; the sum depends on how finely the path is cut
  path = 1        ///< a random walk: the given sd after one metre, however many increments it took
};

/// Noise added to increments that are (nearly) true, so that a filter has something to do.
struct AddedNoise {
  bool enabled = true;
  double distance = 0.05;         ///< sd of the length [m/m, or m/sqrt(m) for NoiseGrowth::path]
  double heading = radians(3.0);  ///< sd of the heading [rad/m, or rad/sqrt(m) for NoiseGrowth::path]
  NoiseGrowth growth = NoiseGrowth::increment;
  std::uint64_t seed = 1;  ///< not listed below: the run has one seed, which its caller gives

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("enabled", &AddedNoise::enabled, unit::one, "whether noise is added to the increments at all");
    v.field("distance", &AddedNoise::distance, unit::one,
            "error of the length, as a fraction (growth: increment) or per sqrt(m)", at_least(0.0));
    v.field("heading_deg", &AddedNoise::heading, unit::degree,
            "heading error per metre (growth: increment) or per sqrt(m)", at_least(0.0));
    v.choice("growth", &AddedNoise::growth, {{"increment", NoiseGrowth::increment}, {"path", NoiseGrowth::path}},
             "whether the errors follow each increment's length or are a random walk along the path");
  }
};

struct SonarCorridorParameters {
  std::filesystem::path path{};       ///< folder of measurement.txt and poses.txt
  double half_angle = radians(12.5);  ///< half opening of a sonar's cone [rad]; not documented
  double ring_radius = 0.0;           ///< of the sonars about the robot's centre [m]; not documented
  double min_range = 0.15;            ///< [m]
  double max_range = 5.1;             ///< [m]
  AddedNoise noise{};

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SonarCorridorParameters;
    v.field("path", &P::path, unit::one, "folder of measurement.txt and poses.txt");
    v.field("half_angle_deg", &P::half_angle, unit::degree, "half the opening of a sonar's cone", positive());
    v.field("ring_radius_m", &P::ring_radius, unit::metre, "distance of the sonars from the robot's centre",
            at_least(0.0));
    v.field("min_range_m", &P::min_range, unit::metre, "shorter ranges count as saturated", at_least(0.0));
    v.field("max_range_m", &P::max_range, unit::metre, "longer ranges count as no echo", positive());
    v.group("noise", &P::noise, "noise added to the increments of the given poses");
  }
  [[nodiscard]] std::string validate() const {
    return min_range < max_range ? "" : "expected min_range_m below max_range_m";
  }
};

/// measurement.txt: t [ms], r1..r8 [mm], 5110 = no echo; bearings -90 (right), -37.5, -22.5, -7.5, 7.5, 22.5, 37.5, 90
/// degrees. poses.txt: t [ms], x, y [mm], heading [0.1 deg]. Each sonar answers every second row; in between its range
/// is repeated, while the robot moves on: a range equal to a fresh one of the row before is a repetition
/// (Echo::invalid).
/// Yields at each row an UltrasonicScan of eight beams, the given pose as GroundTruth (not independent: it looks like
/// smoothed odometry) and, from the second row on, Odometry: the increment of the given poses with noise added, its
/// covariance being exactly that of the added noise.
class SonarCorridor : public RecordedSource {
 public:
  /// \throws InputError for missing or damaged files, negative ranges, times that step back or differ between the files
  explicit SonarCorridor(const SonarCorridorParameters& parameters);
};

}  // namespace noctule::datasets
