#pragma once
/// The motion prior as proposal: odometry is summed up with its covariance and drawn from once per observation.
#include "core/gaussian.hpp"
#include "core/observations.hpp"
#include "core/state_archive.hpp"

namespace noctule::filters {

class OdometryProposal {
 public:
  /// Appends an increment, its error independent of those before.
  void add(const Odometry& odometry) { motion_ = motion_ * PoseGaussian{odometry.increment, odometry.covariance}; }

  /// Motion since the last reset, in the base's frame of then.
  [[nodiscard]] const PoseGaussian& motion() const { return motion_; }

  /// Draws motions; made once per observation, used by all particles.
  class Sampler {
   public:
    explicit Sampler(const PoseGaussian& motion)
        : mean_(motion.mean), certain_(motion.covariance.isZero(0.0)), root_(square_root<3>(motion.covariance)) {}
    [[nodiscard]] Pose2 operator()(Rng rng) const {
      if (certain_) return mean_;
      const Vector3 error = sample_gaussian<3>(root_, rng);
      return {mean_.x + error[0], mean_.y + error[1], mean_.yaw + error[2]};
    }

   private:
    Pose2 mean_;
    bool certain_;
    Matrix3 root_;
  };

  void reset() { motion_ = {}; }
  void transfer(StateArchive& archive) { archive(motion_); }

 private:
  PoseGaussian motion_;
};

}  // namespace noctule::filters
