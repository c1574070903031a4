#pragma once
/// UFastSLAM (Kim, Sakthivel, Chung: "Unscented FastSLAM", T-RO 2008) and its particle swarm.
#include "filters/slam/landmark_slam.hpp"
#include "filters/slam/particle_kernel.hpp"

namespace noctule::filters {

/// Like FastSLAM 2, with unscented transforms in place of Jacobians: in the sum of odometry, in the proposal, and in
/// the landmarks. Corrections of the published form: the proposal knows the landmarks' uncertainty (variant erb; the
/// variant 2008 takes them as certain), alpha is 0.9 (0.002 loses all digits), the density has its whole (2 pi)^d.
class UFastSlam : public LandmarkSlam {
 public:
  explicit UFastSlam(const UFastSlamParameters& parameters, std::uint64_t seed, const Pose2& start = {},
                     const OffspringTempering& tempering = {});

 protected:
  void add_motion(const Odometry& odometry) override;
  [[nodiscard]] bool may_wait() const override;
  void take_in(std::size_t begin, std::size_t end) override;
  void propose(std::size_t begin, std::size_t end) override;
  void update_maps(std::size_t begin, std::size_t end) override;

  [[nodiscard]] MotionPosterior posterior(const ParticleView& view, const Pose2& before);
  void update_landmarks(const ParticleView& view, const Pose2& pose);

 private:
  UnscentedVariant variant_;
  UnscentedScaling scaling_;
  double linear_within_;
};

/// After the resampling, particles move towards poses of greater posterior density (motion prior times likelihood of
/// the scan): each remembers its best pose and is drawn to that of all. Landmarks are updated at the pose found, so
/// that the scan enters once. Moves are made in the coordinates in which the motion prior is N(0, I): they leave no
/// direction in which two controls cannot move the robot.
class PsoUFastSlam final : public UFastSlam {
 public:
  explicit PsoUFastSlam(const PsoUFastSlamParameters& parameters, std::uint64_t seed, const Pose2& start = {});

 private:
  /// A particle of the swarm; vectors in units of the motion prior.
  struct Member {
    Pose2 before;  ///< pose before the motion
    MotionPosterior proposal;
    Vector3 place, velocity, best, reach;  ///< reach: greatest velocity
    Matrix3 spread;                        ///< square root of the proposal's covariance
    double density;                        ///< log posterior density at `best`, but for a constant
    double nis;                            ///< of the scan there
  };
  struct Fitness {
    double density, likelihood, nis;
  };

  void observe(const Stamp& stamp) override;
  [[nodiscard]] Vector3 in_prior(const Pose2& motion) const;
  [[nodiscard]] Pose2 motion_at(const Vector3& place) const;
  [[nodiscard]] Fitness fitness(std::size_t i, const Vector3& place);
  void propose(std::size_t begin, std::size_t end) override;
  void inherit(std::span<const std::uint32_t> ancestors);
  void swarm(bool weighed);
  void begin_moves(std::size_t i);
  void move(std::size_t i, int iteration, const Pose2* target);
  [[nodiscard]] const Pose2* find_target();
  void settle(std::size_t i);

  SwarmWeighting weighting_;
  SwarmMoves when_;
  SwarmParameters swarm_;
  std::vector<Member> members_;
  std::vector<double> log_weights_;
  Matrix3 prior_root_ = Matrix3::Zero();
  Pose2 target_;
};

}  // namespace noctule::filters
