#pragma once
/// The motion prior as proposal: odometry is summed up with its covariance and drawn from once per observation.
#include "core/gaussian.hpp"
#include "core/observations.hpp"
#include "core/state_archive.hpp"

namespace noctule::filters {

/// Motion of all particles since the last observation, whitened: mean + root u, u standard normal (three numbers). Made
/// once per observation, used by all particles.
struct WhitenedMotion {
  explicit WhitenedMotion(const PoseGaussian& motion) : mean(motion.mean), root(square_root<3>(motion.covariance)) {}
  /// The pose a particle moves to.
  [[nodiscard]] Pose2 moved(const Pose2& from, const Vector3& u) const {
    const Vector3 d = root * u;
    return from * Pose2{mean.x + d[0], mean.y + d[1], mean.yaw + d[2]};
  }
  [[nodiscard]] Pose2 drawn(const Pose2& from, Rng rng) const {
    Vector3 u;
    for (int i = 0; i < 3; ++i) u[i] = rng.normal();
    return moved(from, u);
  }
  Pose2 mean;
  Matrix3 root;
};

class OdometryProposal {
 public:
  /// Appends an increment, its error independent of those before.
  void add(const Odometry& odometry) { motion_ = motion_ * PoseGaussian{odometry.increment, odometry.covariance}; }

  /// Motion since the last reset, in the base's frame of then.
  [[nodiscard]] const PoseGaussian& motion() const { return motion_; }

  void reset() { motion_ = {}; }
  void transfer(StateArchive& archive) { archive(motion_); }

 private:
  PoseGaussian motion_;
};

}  // namespace noctule::filters
