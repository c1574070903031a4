#include "filters/slam/path_particles.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "particle/pose_apf.hpp"

namespace noctule::filters {

PathParticles::PathParticles(std::size_t size, const Pose2& start, const ResamplingRule& rule, std::uint64_t seed,
                             std::uint64_t stream)
    : rule_(rule),
      resampler_(particle::make_resampler(rule.method)),
      seed_(seed),
      stream_(stream),
      poses_(size, start),
      weights_(size),
      paths_(size),
      log_likelihoods_(size),
      linear_(size),
      drawn_with_(size),
      copy_weights_(size),
      counts_(size),
      ancestors_(size) {
  estimate_.pose = start;
  estimate_.particles = estimate_.distinct_particles = estimate_.distinct_ancestors = static_cast<int>(size);
  estimate_.effective_sample_size = static_cast<double>(size);
}

void PathParticles::weigh(std::span<const ObservationFit> fits) {
  std::ranges::transform(fits, log_likelihoods_.begin(), &ObservationFit::log_likelihood);
  weights_.multiply(log_likelihoods_);
  note_weights();
  estimate_.effective_sample_size = weights_.effective_sample_size();
}

void PathParticles::reweigh(std::span<const double> log_weights) {
  weights_.assign(log_weights);
  note_weights();
}

void PathParticles::note_weights() {
  weights_.linear(linear_);
  best_ = static_cast<std::size_t>(std::ranges::max_element(linear_) - linear_.begin());
}

void PathParticles::record(const Stamp& stamp, std::span<const ObservationFit> fits, const PoseGaussian& pending) {
  record_estimate(stamp, fits, pending);
  record_paths(stamp);
}

void PathParticles::record_paths(const Stamp& stamp) {
  for (std::size_t i = 0; i < poses_.size(); ++i) paths_.append(i, {stamp.seq, stamp.utime, present(i)});
}

void PathParticles::record_estimate(const Stamp& stamp, std::span<const ObservationFit> fits,
                                    const PoseGaussian& pending) {
  pending_ = pending;
  moving_ = pending.mean != Pose2{} || !pending.covariance.isZero(0.0);
  Pose2 mean;
  double cosine = 0.0, sine = 0.0, nis = 0.0, degrees_of_freedom = 0.0;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const Pose2 pose = present(i);
    mean.x += linear_[i] * pose.x;
    mean.y += linear_[i] * pose.y;
    cosine += linear_[i] * std::cos(pose.yaw);
    sine += linear_[i] * std::sin(pose.yaw);
    nis += linear_[i] * fits[i].nis;
    degrees_of_freedom += linear_[i] * fits[i].degrees_of_freedom;
  }
  mean.yaw = std::atan2(sine, cosine);
  Matrix3 covariance = Matrix3::Zero();
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const Vector3 d = difference(present(i), mean);
    covariance += linear_[i] * d * d.transpose();
  }
  if (moving_) {
    const Matrix3 turn = compose_jacobian_right({0.0, 0.0, mean.yaw - pending_.mean.yaw});  // of the mean before it
    covariance += turn * pending_.covariance * turn.transpose();
  }
  estimate_.stamp = stamp;
  estimate_.pose = mean;
  estimate_.covariance = covariance;
  estimate_.nis = degrees_of_freedom > 0.0 ? nis / degrees_of_freedom : 0.0;
}

/// \post drawn_with_ holds the weights that offspring are drawn with
void PathParticles::temper() {
  const double k = rule_.tempering.k;
  const double floor = k > 0.0 && std::isfinite(k) ? 1.0 / (k * static_cast<double>(size())) : 0.0;
  const double share = floor > 0.0 ? 1.0 - 1.0 / k : 1.0;
  for (std::size_t i = 0; i < size(); ++i) drawn_with_[i] = share * linear_[i] + floor;
}

/// Moves copies away from their originals, by the spread of all particles at the observation.
void PathParticles::jitter() {
  const OffspringTempering& t = rule_.tempering;
  const Vector3 sd = estimate_.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (std::size_t i = 0; i < size(); ++i) {
    if (ancestors_[i] == i) continue;
    Rng rng(seed_, splitmix64(stream_), step_, static_cast<std::uint32_t>(i));
    poses_[i].x += t.movement * sd[0] * rng.normal();
    poses_[i].y += t.movement * sd[1] * rng.normal();
    poses_[i].yaw = wrap(poses_[i].yaw + t.rotation * sd[2] * rng.normal());
  }
}

std::span<const std::uint32_t> PathParticles::resample(particle::Apf* apf, particle::States states,
                                                       std::span<const particle::MovedParticle>& moves) {
  moves = {};
  const std::size_t n = size();
  estimate_.resampled = estimate_.effective_sample_size < rule_.below * static_cast<double>(n);
  if (estimate_.resampled) {
    temper();
    Rng rng(seed_, stream_, step_);
    resampler_->offspring(drawn_with_, static_cast<std::uint32_t>(n), rng, counts_, copy_weights_);
    const bool regularised = rule_.method == particle::Resampling::regularised;
    std::optional<particle::Spread> before;
    if (regularised) before.emplace(particle::pose_states(std::span<const Pose2>(poses_)), linear_);
    if (apf != nullptr) {
      moves = apf->optimise(states, linear_, counts_, ancestors_, rng);
      for (const particle::MovedParticle& move : moves) {
        ancestors_[move.slot] = move.toward;
        --counts_[move.from];
        ++counts_[move.toward];
      }
    } else {
      particle::place_in_slots(counts_, ancestors_, free_);
    }
    // Survivors keep their slots, so that none is overwritten before it is copied.
    for (std::size_t i = 0; i < n; ++i) poses_[i] = poses_[ancestors_[i]];
    paths_.resample(ancestors_);
    if (regularised) particle::regularise(*before, particle::pose_states(std::span<Pose2>(poses_)), rng);
    if (rule_.tempering.movement > 0.0 || rule_.tempering.rotation > 0.0) jitter();
    const bool corrected = rule_.tempering.corrected && rule_.tempering.k > 0.0;
    if (corrected || !resampler_->equal_weights()) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t a = ancestors_[i];
        log_likelihoods_[i] =
            std::log(copy_weights_[a]) + (corrected ? std::log(linear_[a]) - std::log(drawn_with_[a]) : 0.0);
      }
      weights_.assign(log_likelihoods_);
    } else {
      weights_.make_uniform();
    }
    if (counts_[best_] == 0) {
      for (std::size_t i = 0; i < n; ++i) {
        if (counts_[i] > 0 && (counts_[best_] == 0 || linear_[i] > linear_[best_])) best_ = i;
      }
    }
    estimate_.distinct_particles = static_cast<int>(n - static_cast<std::size_t>(std::ranges::count(counts_, 0u)));
    estimate_.distinct_ancestors = static_cast<int>(paths_.distinct_founders());
  }
  ++step_;
  return estimate_.resampled ? std::span<const std::uint32_t>(ancestors_) : std::span<const std::uint32_t>();
}

void PathParticles::spread(const ParticleCloud& poses) {
  if (poses.particles.empty()) throw InputError("poses to begin at: expected some, got none");
  double total = 0.0;
  for (const WeightedPose& p : poses.particles) total += p.weight;
  double cumulative = poses.particles[0].weight;
  for (std::size_t i = 0, k = 0; i < size(); ++i) {
    const double tooth = (static_cast<double>(i) + 0.5) / static_cast<double>(size()) * total;
    while (cumulative < tooth && k + 1 < poses.particles.size()) cumulative += poses.particles[++k].weight;
    poses_[i] = poses.particles[k].pose;
  }
  estimate_.pose = poses_[0];
}

void PathParticles::transfer(StateArchive& archive) {
  archive(step_, poses_, pending_, moving_, weights_, best_);
  paths_.transfer(archive, [&](PathPose& p) { archive(p.scan_seq, p.utime, p.pose); });
  SlamEstimate& e = estimate_;
  archive(e.stamp, e.pose, e.covariance, e.particles, e.effective_sample_size, e.distinct_particles,
          e.distinct_ancestors, e.resampled, e.noise_scale, e.nis);
}

ParticleCloud PathParticles::cloud(int at_most) const {
  ParticleCloud cloud{estimate_.stamp, {}};
  const std::vector<double> weights = weights_.linear();
  const auto size = static_cast<std::size_t>(std::max(at_most, 0));
  if (poses_.size() <= size) {
    for (std::size_t i = 0; i < poses_.size(); ++i) cloud.particles.push_back({present(i), weights[i]});
    return cloud;
  }
  double cumulative = weights[0];
  for (std::size_t m = 0, i = 0; m < size; ++m) {
    const double tooth = (static_cast<double>(m) + 0.5) / static_cast<double>(size);
    while (cumulative < tooth && i + 1 < weights.size()) cumulative += weights[++i];
    cloud.particles.push_back({present(i), 1.0 / static_cast<double>(size)});
  }
  return cloud;
}

}  // namespace noctule::filters
