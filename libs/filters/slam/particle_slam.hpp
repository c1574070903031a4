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
#include "filters/noise/noise_model.hpp"
#include "filters/slam/contour_landmark.hpp"
#include "filters/slam/contour_observation.hpp"
#include "filters/slam/odometry_proposal.hpp"
#include "filters/slam/parameters.hpp"
#include "filters/slam/path_smoother.hpp"
#include "filters/slam/sightings.hpp"
#include "filters/slam/slam_filter.hpp"
#include "particle/genealogy.hpp"
#include "particle/resampling.hpp"
#include "particle/weights.hpp"

namespace noctule::filters {

/// The proposal is the motion prior (FastSLAM 1), the weight the likelihood of what was heard or seen: an echo as range
/// and coarse bearing on one landmark or on clutter, a sighting as range and bearing of one landmark.
class ParticleSlam : public SlamFilter {
 public:
  /// \param start pose of the base in the map at the first observation, taken as certain
  /// \throws InputError on a start that is not finite or parameters that make no filter
  explicit ParticleSlam(const ParticleSlamParameters& parameters, std::uint64_t seed, const Pose2& start = {});

  /// Summed up and drawn from at the next observation.
  void predict(const Odometry& odometry) override;
  /// Features only start landmarks.
  void update(const UltrasonicScan& scan, const ContourFeatures& features) override;
  /// \throws InputError also on bearing-only and range-only sightings, which this filter does not use
  void update(const LandmarkDetections& detections) override;

  [[nodiscard]] SlamEstimate estimate() const override { return estimate_; }
  [[nodiscard]] PathEstimate path() const override;
  /// What path() and map() are taken from when `smooth_path` says so, with covariances; else nothing. Solved anew at
  /// each call, in time linear in the length of the run.
  [[nodiscard]] std::optional<SmoothedPath> smoothed() const;
  [[nodiscard]] LandmarkMap map() const override;
  [[nodiscard]] ParticleCloud particles(int at_most) const override;
  [[nodiscard]] std::int64_t collapses() const override { return weights_.collapses(); }

 private:
  struct Map {
    std::vector<ContourLandmark> contours;
    std::vector<PointLandmark> points;
  };

  void move_particles();
  /// \param apply ObservationFit(particle, scratch), what the observation does to one particle
  /// \param learn void(weights), before resampling
  template <class Apply, class Learn>
  void observe(const Stamp& stamp, Apply apply, Learn learn);
  void learn_noise(std::size_t echoes, std::span<const double> weights);
  void note_estimate(const Stamp& stamp, std::span<const double> weights, std::span<const ObservationFit> fits);
  void resample(std::span<const double> weights);
  [[nodiscard]] LandmarkMap filtered_map() const;

  ParticleSlamParameters parameters_;
  std::uint64_t seed_;
  std::unique_ptr<const particle::Resampler> resampler_;
  OdometryProposal proposal_;
  NoiseModel<1> noise_;                    ///< of echo ranges, in units of the nominal sd
  std::vector<EchoResidual> residuals_;    ///< of the present scan, all echoes of the first particle, then of the next
  std::vector<NoiseResidual<1>> learned_;  ///< scratch

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
  std::optional<PathSmoother> smoother_;
};

}  // namespace noctule::filters
