#pragma once
/// One ultrasonic scan, prepared once for all particles, and what it does to the map of one of them.
#include <span>
#include <vector>

#include "core/features.hpp"
#include "filters/slam/contour_landmark.hpp"
#include "filters/slam/odometry_proposal.hpp"
#include "filters/slam/parameters.hpp"
#include "filters/slam/path_particles.hpp"

namespace noctule::filters {

/// What the learning of noise takes from one echo and one particle.
struct EchoResidual {
  double mean = 0.0, second_moment = 0.0;  ///< see NoiseResidual
  double noise = 0.0;                      ///< variance the gain was made of; 0: clutter
};

/// A pose drawn for a particle, and the log of the density it had in the motion prior over that in the proposal.
struct DrawnPose {
  Pose2 pose;
  double log_correction;
};

class ContourObservation {
 public:
  /// \param noise of ranges, to outlive this object; none: Gaussian with the nominal variance
  /// \param stop number of the stop the scan was taken at
  /// \param first_id identity of the first feature's landmark, should it become one; the k-th gets first_id - k
  /// The scan and the features are checked already and must outlive this object.
  ContourObservation(const UltrasonicScan& scan, const ContourFeatures& features, int stop, std::int64_t first_id,
                     const ParticleSlamParameters& parameters, const models::NoiseMixture<1>* noise = nullptr);

  [[nodiscard]] std::size_t echoes() const { return pings_.size(); }

  /// Draws the pose of a particle given the echoes, as FastSLAM 2 does: a Gaussian of the motion, updated by the echoes
  /// of each landmark in the map, with the landmark's uncertainty, which the echoes of one landmark share. Only a
  /// proposal: the correction makes up for whatever is not Gaussian or not well associated.
  /// \param before pose of the particle at the last observation
  /// \param assigned scratch
  DrawnPose draw_pose(const Pose2& before, const WhitenedMotion& motion, const std::vector<ContourLandmark>& map,
                      std::vector<std::int32_t>& assigned, Rng rng) const;

  /// Gives each echo to the landmark that explains it best, or to clutter; each enters at most one landmark, once.
  /// Then starts landmarks from those features whose echoes of this scan are mostly unexplained and that lie apart from
  /// all known ones, and gives them these echoes. Removes landmarks that failed.
  /// \param base pose of the particle in the map
  /// \param explained scratch
  /// \param residuals one per echo, filled where the noise is learned; else empty
  ObservationFit apply(const Pose2& base, std::vector<ContourLandmark>& map, std::vector<char>& explained,
                       std::span<EchoResidual> residuals = {}) const;

 private:
  struct Ping {
    Vector2 sensor_in_base;
    Vector2 axis;  ///< unit vector in base_link
    double range;
    double range_variance;
    double gate2;  ///< see PlacedEcho
  };
  /// Pose of a particle with its rotation matrix, made once for all pings.
  struct Frame {
    explicit Frame(const Pose2& pose);
    Pose2 base;
    Matrix2 rotation;
  };
  struct Start {
    const ContourFeature* feature;
    std::vector<std::size_t> pings;  ///< of this scan, indices into pings_
    std::int64_t id;
  };
  [[nodiscard]] PlacedEcho place(const Frame& frame, const Ping& ping) const;
  /// Whether a landmark is expected near the feature's surface, whatever the noise made of its echoes.
  [[nodiscard]] bool is_known(const ContourFeature& feature, const Frame& frame,
                              const std::vector<ContourLandmark>& map) const;
  void start_landmarks(const Frame& frame, std::vector<ContourLandmark>& map, std::vector<char>& explained,
                       std::span<EchoResidual> residuals) const;

  const ParticleSlamParameters& parameters_;
  const models::NoiseMixture<1>* noise_;
  int stop_;
  double bearing_variance_;
  double gate_cosine_;
  double log_clutter_;
  std::vector<Ping> pings_;  ///< echoes only
  std::vector<Start> starts_;
};

}  // namespace noctule::filters
