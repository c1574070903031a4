#pragma once
/// PF-SLAM, the baseline: a Rao-Blackwellised particle filter over the path, with walls, cylinders and points as
/// Kalman-filtered landmarks of each particle.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/estimate.hpp"
#include "core/features.hpp"
#include "core/observations.hpp"
#include "filters/slam/contour_landmark.hpp"
#include "filters/slam/contour_observation.hpp"
#include "filters/slam/odometry_proposal.hpp"
#include "filters/slam/parameters.hpp"
#include "filters/slam/sightings.hpp"
#include "particle/genealogy.hpp"
#include "particle/resampling.hpp"
#include "particle/weights.hpp"

namespace noctule::filters {

/// The proposal is the motion prior (FastSLAM 1), the weight the likelihood of what was heard or seen. Every reading
/// enters once: an echo as range and coarse bearing on one landmark or on clutter, a sighting as range and bearing of
/// one landmark. Observations that are not finite or otherwise unusable are refused with InputError and leave the
/// filter as it was. Results depend on parameters, seed and input alone, not on the number of threads.
class ParticleSlam {
 public:
  /// \param start pose of the base in the map at the first observation, taken as certain
  /// \throws InputError on a start that is not finite or parameters that make no filter
  explicit ParticleSlam(const ParticleSlamParameters& parameters, std::uint64_t seed, const Pose2& start = {});

  /// Motion since the previous call; summed up and drawn from at the next observation.
  void predict(const Odometry& odometry);

  /// \param features what the extractor made of the readings up to this scan, in base_link at the scan; they only start
  ///        landmarks. May be empty, or stale (no readings of this scan): then none is started.
  /// \throws InputError also when the scan's seq is not above that of the previous one
  void update(const UltrasonicScan& scan, const ContourFeatures& features);

  /// Range-bearing sightings with known or unknown identity. Ids that the filter gives to landmarks of its own are
  /// below -1.
  /// \throws InputError also on bearing-only and range-only sightings, which this filter does not use, and when the seq
  ///         is not above that of the previous message
  void update(const LandmarkDetections& detections);

  /// As of the latest observation, before resampling; the start before any.
  [[nodiscard]] SlamEstimate estimate() const { return estimate_; }
  /// One pose per observation (scan or message of sightings), each with the seq of its own channel.
  [[nodiscard]] PathEstimate path() const;
  [[nodiscard]] LandmarkMap map() const;
  /// All particles, or `at_most` drawn systematically, equally weighted.
  [[nodiscard]] ParticleCloud particles(int at_most) const;
  /// How often the likelihood of all particles was 0 and the weights were made equal.
  [[nodiscard]] std::int64_t collapses() const { return weights_.collapses(); }

 private:
  struct Map {
    std::vector<ContourLandmark> contours;
    std::vector<PointLandmark> points;
  };

  void move_particles();
  template <class Apply>
  void observe(const Stamp& stamp, Apply apply);
  void note_estimate(const Stamp& stamp, std::span<const double> weights, std::span<const ObservationFit> fits);
  void resample(std::span<const double> weights);

  ParticleSlamParameters parameters_;
  std::uint64_t seed_;
  std::unique_ptr<const particle::Resampler> resampler_;
  OdometryProposal proposal_;

  // One entry per particle.
  std::vector<Pose2> poses_;
  std::vector<Map> maps_;
  particle::Weights weights_;
  particle::Genealogy<PathPose> paths_;
  std::size_t best_ = 0;  ///< particle of greatest weight at the latest observation, or its heaviest survivor

  SlamEstimate estimate_;
  std::uint64_t step_ = 0;      ///< observations so far
  std::int64_t next_id_ = -2;   ///< of the next landmark the filter names, counting down
  int stop_ = 0;                ///< number of the present stop ...
  double way_from_stop_ = 0.0;  ///< ... and how far odometry is from where it began [m]
  std::optional<std::int64_t> last_scan_, last_detections_;
};

}  // namespace noctule::filters
