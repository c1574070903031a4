#pragma once
/// FastSLAM 1 and 2: Rao-Blackwellised filters whose landmarks are extended Kalman filters.
#include "filters/slam/landmark_slam.hpp"

namespace noctule::filters {

/// Particles move by the motion prior and are weighed at the pose they have then.
class FastSlam1 final : public LandmarkSlam {
 public:
  /// \param start pose of the base in the map at the first observation, taken as certain
  /// \throws InputError on a start that is not finite or parameters that make no filter
  explicit FastSlam1(const FastSlam1Parameters& parameters, std::uint64_t seed, const Pose2& start = {},
                     const OffspringTempering& tempering = {});

  void transfer(StateArchive& archive) override {
    LandmarkSlam::transfer(archive);
    archive(odometry_);
  }

 private:
  void add_motion(const Odometry& odometry) override;
  void before_association() override;
  void take_in(std::size_t begin, std::size_t end) override;
  void propose(std::size_t begin, std::size_t end) override;
  void update_maps(std::size_t begin, std::size_t end) override;
  double log_density_of_motion(std::size_t i, const Pose2& motion) override;
  Pose2 another_motion(std::size_t i, Rng& rng) override;
  void move(const PoseGaussian& motion, std::uint64_t stream, std::uint64_t step);

  Sampling sample_;
  PoseGaussian prior_;          ///< of the motion to the present scan
  std::uint64_t odometry_ = 0;  ///< messages so far
};

/// The Gaussian motion prior of each particle is updated by one sighting of a known landmark after the other, each time
/// linearised anew; the particle is drawn from the result. Its weight is the product of the innovations' likelihoods,
/// the marginal likelihood of the scan to first order. (The published form inverts the prior, which two controls make
/// singular, and divides prior by proposal.)
class FastSlam2 final : public LandmarkSlam {
 public:
  explicit FastSlam2(const FastSlam2Parameters& parameters, std::uint64_t seed, const Pose2& start = {},
                     const OffspringTempering& tempering = {});

 private:
  [[nodiscard]] bool may_wait() const override;
  void take_in(std::size_t begin, std::size_t end) override;

  void propose(std::size_t begin, std::size_t end) override;
  void update_maps(std::size_t begin, std::size_t end) override;

  double linear_within_;
};

}  // namespace noctule::filters
