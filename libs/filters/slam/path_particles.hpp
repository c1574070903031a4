#pragma once
/// What every Rao-Blackwellised filter over the path has, whatever its landmarks are: poses, weights, histories,
/// resampling, and the estimate they make up.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/estimate.hpp"
#include "core/stamp.hpp"
#include "filters/slam/observation_fit.hpp"
#include "filters/slam/parameters.hpp"
#include "particle/apf.hpp"
#include "particle/genealogy.hpp"
#include "particle/weights.hpp"

namespace noctule::filters {

struct ResamplingRule {
  particle::Resampling method = particle::Resampling::systematic;
  double below = 0.5;  ///< resample when the effective sample size falls below this share of the particles
  OffspringTempering tempering;
};

class PathParticles {
 public:
  /// \param stream of the random numbers of resampling
  PathParticles(std::size_t size, const Pose2& start, const ResamplingRule& rule, std::uint64_t seed,
                std::uint64_t stream);

  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  /// One per particle: at the latest observation, once the filter has moved them there.
  std::vector<Pose2>& poses() { return poses_; }
  [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }
  [[nodiscard]] const particle::Weights& weights() const { return weights_; }
  /// Number of observations so far: the step of the random numbers.
  [[nodiscard]] std::uint64_t step() const { return step_; }
  /// Particle of greatest weight at the latest observation, or its heaviest survivor.
  [[nodiscard]] std::size_t best() const { return best_; }

  /// An observation: the weights are multiplied by what it said, ...
  void weigh(std::span<const ObservationFit> fits);
  /// ... paths and estimate are continued by the poses there, ...
  /// \param pending motion that is still to be drawn, in the frame of each pose
  void record(const Stamp& stamp, std::span<const ObservationFit> fits, const PoseGaussian& pending = {});
  /// (these two do the same for filters that move particles after the resampling: the estimate before it, paths after)
  void record_estimate(const Stamp& stamp, std::span<const ObservationFit> fits, const PoseGaussian& pending = {});
  void record_paths(const Stamp& stamp);
  /// ... and the particles are redrawn where the weights ask for it. This ends the step.
  /// \return ancestors, placed by particle::place_in_slots, valid until the next call; empty when nothing changed
  std::span<const std::uint32_t> resample() { return resample(nullptr, {}, moves_); }
  /// The same with neighbour optimisation where `apf` is not null. A particle that moves takes map and path of the
  /// neighbour it moves toward; its pose is not changed here.
  /// \param states of the particles, in which the optimisation moves them
  /// \param[out] moves those that move, valid until the next call
  std::span<const std::uint32_t> resample(particle::Apf* apf, particle::States states,
                                          std::span<const particle::MovedParticle>& moves);
  /// Replaces the weights by others, given as logs, not necessarily normalised.
  void reweigh(std::span<const double> log_weights);

  [[nodiscard]] const SlamEstimate& estimate() const { return estimate_; }
  [[nodiscard]] PathEstimate path() const { return {estimate_.stamp, paths_.history(best_)}; }
  [[nodiscard]] ParticleCloud cloud(int at_most) const;
  /// Before any observation: spreads the particles over these poses, as their weights say.
  /// \throws InputError when there is none
  void spread(const ParticleCloud& poses);

  void transfer(StateArchive& archive);

 private:
  [[nodiscard]] Pose2 present(std::size_t i) const { return moving_ ? poses_[i] * pending_.mean : poses_[i]; }
  void note_weights();
  void temper();
  void jitter();

  ResamplingRule rule_;
  std::unique_ptr<const particle::Resampler> resampler_;
  std::uint64_t seed_, stream_, step_ = 0;
  std::vector<Pose2> poses_;
  PoseGaussian pending_;
  bool moving_ = false;  ///< there is motion to be drawn
  particle::Weights weights_;
  particle::Genealogy<PathPose> paths_;
  std::size_t best_ = 0;
  SlamEstimate estimate_;
  std::span<const particle::MovedParticle> moves_;
  // Scratch, kept so that an observation allocates nothing.
  std::vector<double> log_likelihoods_, linear_, drawn_with_, copy_weights_;
  std::vector<std::uint32_t> counts_, ancestors_, free_;
};

}  // namespace noctule::filters
