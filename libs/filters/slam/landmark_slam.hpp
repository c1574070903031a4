#pragma once
/// The particle filters over point landmarks: what they share. A filter is a proposal (how particles move to a scan and
/// what it weighs there) and a landmark update, put together at compile time (particle_kernel.hpp).
#include <cstdint>
#include <optional>
#include <vector>

#include "filters/slam/landmark_parameters.hpp"
#include "filters/slam/path_particles.hpp"
#include "filters/slam/point_maps.hpp"
#include "filters/slam/slam_filter.hpp"
#include "particle/parallel.hpp"

namespace noctule::filters {

/// A scan is taken in by steps: odometry is summed up, once for all particles, as a motion in the frame of each pose;
/// sightings are associated with each particle's landmarks; the particles move, are weighed, and update their maps.
class LandmarkSlam : public SlamFilter {
 public:
  void predict(const Odometry& odometry) override;
  void update(const LandmarkDetections& detections) override;
  /// \throws InputError always
  void update(const UltrasonicScan& scan, const ContourFeatures& features) override;

  [[nodiscard]] SlamEstimate estimate() const override { return particles_.estimate(); }
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
  /// The steps of a scan from the association on.
  virtual void observe(const Stamp& stamp);

  /// Runs body(begin, end) over all particles.
  template <class Body>
  void for_particles(const Body& body) {
    particle::for_blocks(particles_.size(), parameters_.threads, body);
  }
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
  PoseGaussian motion_;  ///< still to be drawn, in the frame of each pose
  std::vector<ObservationFit> fits_;

 private:
  std::int64_t next_id_ = -2;  ///< of the next landmark the filter names, counting down
  std::optional<std::int64_t> last_detections_;
};

}  // namespace noctule::filters
