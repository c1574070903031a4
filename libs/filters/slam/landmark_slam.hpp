#pragma once
/// The particle filters over point landmarks: what they share. A filter is a proposal (how particles move to a scan and
/// what it weighs there) and a landmark update, put together at compile time (particle_kernel.hpp).
#include <cstdint>
#include <optional>
#include <vector>

#include "core/gaussian.hpp"
#include "filters/slam/landmark_parameters.hpp"
#include "filters/slam/path_particles.hpp"
#include "filters/slam/point_maps.hpp"
#include "filters/slam/sighting_noise.hpp"
#include "filters/slam/slam_filter.hpp"
#include "particle/parallel.hpp"

namespace noctule::filters {

/// Gaussian of a particle's motion, in the frame of its pose before, and how well it explains the scan.
struct MotionPosterior {
  Vector3 mean;
  Matrix3 covariance;
  ObservationFit fit;
};

[[nodiscard]] inline Pose2 draw_motion(const MotionPosterior& q, Rng& rng) {
  const Vector3 drawn = q.mean + sample_gaussian<3>(semidefinite_cholesky<3>(q.covariance), rng);
  return {drawn[0], drawn[1], drawn[2]};
}

/// log N(motion; mean, covariance) but for a constant; directions without variance do not count.
[[nodiscard]] double log_density_of_motion(const Pose2& motion, const Vector3& mean, const Matrix3& covariance);

/// A scan is taken in by steps: odometry is summed up, once for all particles, as a motion in the frame of each pose;
/// sightings are associated with each particle's landmarks; the particles move, are weighed, and update their maps.
class LandmarkSlam : public SlamFilter {
 public:
  void predict(const Odometry& odometry) override;
  void update(const LandmarkDetections& detections) override;
  /// \throws InputError always
  void update(const UltrasonicScan& scan, const ContourFeatures& features) override;

  [[nodiscard]] SlamEstimate estimate() const override;
  [[nodiscard]] PathEstimate path() const override { return particles_.path(); }
  [[nodiscard]] LandmarkMap map() const override;
  [[nodiscard]] ParticleCloud particles(int at_most) const override { return particles_.cloud(at_most); }
  [[nodiscard]] std::int64_t collapses() const override { return particles_.weights().collapses(); }

  void begin_on(const LandmarkMap& map, const ParticleCloud& poses) override;
  void transfer(StateArchive& archive) override;

  /// Memory of all landmarks [bytes].
  [[nodiscard]] std::size_t map_bytes() const { return points_.maps().bytes(); }

 protected:
  /// \param name of the filter in errors
  LandmarkSlam(const char* name, const LandmarkSlamParameters& parameters, const OffspringTempering& tempering,
               std::uint64_t seed, const Pose2& start);

  /// Appends odometry to the motion to be drawn.
  virtual void add_motion(const Odometry& odometry);
  /// Before the scan is associated: filters that draw from the motion prior do it here.
  virtual void before_association() {}
  /// Whether a message without sightings leaves the particles where they are, so that the motion is drawn when there is
  /// something to see.
  [[nodiscard]] virtual bool may_wait() const { return false; }
  /// Moves particles [begin, end) by motion_, notes what they say of the scan in fits_, and updates their maps, which
  /// are writable.
  virtual void take_in(std::size_t begin, std::size_t end) = 0;
  /// What optimise: apf needs, which resamples before maps are updated. Moves particles [begin, end) by motion_, notes
  /// their fits_ and leaves their maps alone.
  virtual void propose(std::size_t begin, std::size_t end) = 0;
  /// Takes the scan into the maps of particles [begin, end), at the poses they have.
  virtual void update_maps(std::size_t begin, std::size_t end) = 0;
  /// Log density of a motion of particle i given the scan, but for a constant.
  [[nodiscard]] virtual double log_density_of_motion(std::size_t i, const Pose2& motion);
  /// Another motion of particle i that its weight stands for too.
  [[nodiscard]] virtual Pose2 another_motion(std::size_t i, Rng& rng);
  /// The steps of a scan from the association on.
  virtual void observe(const Stamp& stamp);

  /// Runs body(begin, end) over all particles.
  template <class Body>
  void for_particles(const Body& body) {
    particle::for_blocks(particles_.size(), parameters_.threads, body);
  }
  /// Runs body(noise) with the noise as kernels want it.
  template <class Body>
  auto with_noise(const Body& body) {
    return noise_.learns() ? body(LearnedNoise{noise_}) : body(StatedNoise{});
  }
  /// Births and deaths of landmarks, where the weights have the scan already: births add to them.
  void live_after_weighing();
  /// Of what the particles noted, with their present weights.
  void learn_noise();
  /// \return ancestors; empty when nothing changed
  std::span<const std::uint32_t> resample();
  /// Of its motion, for a particle at an observation.
  [[nodiscard]] Rng motion_rng(std::size_t i) const {
    return Rng(seed_, stream_id("landmark_slam.motion"), particles_.step(), static_cast<std::uint32_t>(i));
  }

  LandmarkSlamParameters parameters_;
  std::uint64_t seed_;
  PathParticles particles_;
  PointMaps points_;
  SightingNoise noise_;
  PoseGaussian motion_;  ///< still to be drawn, in the frame of each pose
  std::vector<ObservationFit> fits_;
  // Of optimise: apf.
  std::vector<Pose2> before_;               ///< poses after the latest scan
  std::vector<MotionPosterior> proposals_;  ///< that motions were drawn from, where they are Gaussian

 private:
  void observe_and_optimise(const Stamp& stamp);
  void move_toward_neighbours(std::span<const std::uint32_t> ancestors, std::uint64_t step,
                              std::span<const particle::MovedParticle> moves);
  void weigh();

  particle::Apf apf_;
  std::vector<Pose2> motions_;
  std::int64_t next_id_ = -2;  ///< of the next landmark the filter names, counting down
  std::optional<std::int64_t> last_detections_;
  std::vector<double> linear_;  ///< scratch
};

}  // namespace noctule::filters
