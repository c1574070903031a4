#pragma once
/// PF-SLAM, the baseline: a Rao-Blackwellised particle filter over the path, with walls, cylinders and points as
/// Kalman-filtered landmarks of each particle.
#include <cstdint>
#include <optional>
#include <vector>

#include "core/estimate.hpp"
#include "core/features.hpp"
#include "core/observations.hpp"
#include "filters/noise/noise_model.hpp"
#include "filters/slam/contour_landmark.hpp"
#include "filters/slam/contour_observation.hpp"
#include "filters/slam/odometry_proposal.hpp"
#include "filters/slam/parameters.hpp"
#include "filters/slam/path_particles.hpp"
#include "filters/slam/path_smoother.hpp"
#include "filters/slam/point_maps.hpp"
#include "filters/slam/slam_filter.hpp"

namespace noctule::filters {

/// The proposal is the motion prior (FastSLAM 1), for scans on request the scan too (FastSLAM 2); the weight the
/// likelihood of what was heard or seen: an echo as range and coarse bearing on one landmark or on clutter, a sighting
/// as range, bearing or both of one landmark.
class ParticleSlam : public SlamFilter {
 public:
  /// \param start pose of the base in the map at the first observation, taken as certain
  /// \throws InputError on a start that is not finite or parameters that make no filter
  explicit ParticleSlam(const ParticleSlamParameters& parameters, std::uint64_t seed, const Pose2& start = {});

  /// Summed up and drawn from at the next observation.
  void predict(const Odometry& odometry) override;
  /// Features only start landmarks.
  void update(const UltrasonicScan& scan, const ContourFeatures& features) override;
  void update(const LandmarkDetections& detections) override;

  [[nodiscard]] SlamEstimate estimate() const override;
  [[nodiscard]] PathEstimate path() const override;
  /// What path() and map() are taken from when `smooth_path` says so, with covariances; else nothing. Solved anew at
  /// each call, in time linear in the length of the run.
  [[nodiscard]] std::optional<SmoothedPath> smoothed() const;
  [[nodiscard]] LandmarkMap map() const override;
  [[nodiscard]] ParticleCloud particles(int at_most) const override { return particles_.cloud(at_most); }
  [[nodiscard]] std::int64_t collapses() const override { return particles_.weights().collapses(); }
  void begin_on(const LandmarkMap& map, const ParticleCloud& poses) override;
  void transfer(StateArchive& archive) override;

 private:
  /// Counts stops, and lets the smoother know of the motion. To be called once per observation, before the next.
  void begin_motion();
  void move_particles(const WhitenedMotion& motion);
  [[nodiscard]] Rng motion_rng(std::size_t i) const {
    return Rng(seed_, stream_id("particle_slam.motion"), particles_.step(), static_cast<std::uint32_t>(i));
  }
  /// What all particles say is in fits_.
  /// \param echoes of which the noise is learned, from residuals_
  void observe(const Stamp& stamp, std::size_t echoes = 0);
  void learn_noise(std::size_t echoes);
  [[nodiscard]] LandmarkMap filtered_map() const;

  ParticleSlamParameters parameters_;
  std::uint64_t seed_;
  OdometryProposal proposal_;
  NoiseModel<1> noise_;                    ///< of echo ranges, in units of the nominal sd
  double noise_scale_ = 1.0;               ///< see SlamEstimate
  std::vector<EchoResidual> residuals_;    ///< of the present scan, all echoes of the first particle, then of the next
  std::vector<NoiseResidual<1>> learned_;  ///< scratch
  PathParticles particles_;
  std::vector<std::vector<ContourLandmark>> contours_;  ///< of each particle
  PointMaps points_;
  std::vector<ObservationFit> fits_;

  std::int64_t next_id_ = -2;   ///< of the next landmark the filter names, counting down
  int stop_ = 0;                ///< number of the present stop ...
  double way_from_stop_ = 0.0;  ///< ... and how far odometry is from where it began [m]
  std::optional<std::int64_t> last_scan_, last_detections_;
  std::optional<PathSmoother> smoother_;
};

}  // namespace noctule::filters
