#pragma once
/// What is wrong with a robot's odometry and sightings, systematically and by chance, estimated where truth is known.
#include <span>
#include <vector>

#include "core/angles.hpp"
#include "core/source.hpp"
#include "eval/trajectory.hpp"

namespace noctule::eval {

/// An estimate with the standard deviation of its error.
struct Estimated {
  double value = 0.0;
  double sd = 0.0;
};

struct SensorCalibrationParameters {
  double window = 2.0;   ///< [s] of motion that make one equation
  double max_gap = 0.2;  ///< [s] no equation where truth is missing for longer
  double outlier = 4.0;  ///< residuals above so many robust standard deviations are left out
};

/// Scales are true over odometry; a true range r is measured as range_scale * r + range_bias.
struct SensorCalibration {
  int windows = 0;                       ///< of motion that were used
  int sightings = 0;                     ///< that were used
  int outliers = 0;                      ///< windows and sightings left out
  Estimated distance_scale, turn_scale;  ///< [1]
  Estimated range_scale, range_bias;     ///< [1], [m]
  double range_correlation = 0.0;        ///< of the errors of these two
  Estimated bearing_bias;                ///< [rad] measured minus true
  // Random errors that remain, as in models/odometry.hpp and models/ultrasonic.hpp.
  double along = 0.0;           ///< [m/sqrt(m)]
  double drift = 0.0;           ///< [rad/sqrt(m)]
  double turn = 0.0;            ///< [rad/sqrt(rad)]
  double range_base = 0.0;      ///< [m]
  double range_relative = 0.0;  ///< [1]
  double bearing_sd = 0.0;      ///< [rad]
};

/// Least squares over windows of motion and over the sightings of known landmarks, each once more without its outliers.
/// Distances are compared along the true headings, turns by their sums, so that both are linear in their scale;
/// standard deviations of estimates come from the residuals, taken as independent. What there is no data for is NaN.
/// \param runs of one kind of robot, each in order of time, with GroundTruth; sightings carry ids
/// \throws std::invalid_argument for parameters that are not positive
[[nodiscard]] SensorCalibration calibrate_sensors(std::span<const std::vector<Observation>> runs,
                                                  std::span<const KnownLandmark> landmarks,
                                                  const SensorCalibrationParameters& = {});

}  // namespace noctule::eval
