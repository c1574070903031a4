#pragma once
/// A particle filter for any state space model, with the ways to better its particles.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "particle/apf.hpp"
#include "particle/resampling.hpp"
#include "particle/states.hpp"
#include "particle/swarm.hpp"

namespace noctule::particle {

/// What is done to particles beyond resampling them.
enum class Improvement : std::int8_t {
  none,
  pso,               ///< Swarm::pso before weighting
  bat,               ///< Swarm::bat before weighting
  apf,               ///< Apf after resampling
  resample_move,     ///< resample_move() after resampling
  apf_resample_move  ///< first the one, then the other
};

struct StateFilterParameters {
  int particles = 100;
  Resampling resampling = Resampling::systematic;
  Improvement improvement = Improvement::none;
  SwarmParameters swarm{};
  ApfParameters apf{};
  ResampleMoveParameters moves{};
};

/// Bootstrap filter that resamples at every measurement. Model has
/// - `kDimension`, `kAngles` (bit k: coordinate k is an angle), `Measurement`;
/// - `auto motion(int step)`, a callable (const double* x, double* mean) from step - 1 to `step`, counted from 1;
/// - `std::array<double, kDimension> noise_sd()` of the normal noise added to that mean, `initial_mean()`,
///   `initial_sd()`;
/// - `double log_likelihood(const double* x, const Measurement&)`, up to a constant.
template <class Model>
class StateFilter {
 public:
  static constexpr std::size_t kDimension = Model::kDimension;
  using State = std::array<double, kDimension>;

  /// \throws std::invalid_argument for fewer than one particle
  StateFilter(const Model& model, const StateFilterParameters& parameters, std::uint64_t seed)
      : model_(model),
        parameters_(parameters),
        seed_(seed),
        resampler_(make_resampler(parameters.resampling)),
        swarm_(parameters.swarm),
        apf_(parameters.apf),
        n_(static_cast<std::size_t>(std::max(parameters.particles, 0))),
        states_(n_ * kDimension),
        means_(n_ * kDimension),
        log_likelihoods_(n_),
        carried_(n_, 1.0),
        weights_(n_),
        copy_weights_(n_),
        counts_(n_),
        ancestors_(n_) {
    if (n_ == 0) throw std::invalid_argument("state filter: at least one particle is needed");
    Rng rng(seed_, stream_id("state_filter.start"));
    const State mean = model_.initial_mean(), sd = model_.initial_sd();
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t k = 0; k < kDimension; ++k) states_[i * kDimension + k] = mean[k] + sd[k] * rng.normal();
    }
    wrap_all();
  }

  /// Predicts to the next step, weights by the measurement and resamples.
  void update(const typename Model::Measurement& z) {
    ++step_;
    predict();
    const auto likelihood = [&](const double* x) { return model_.log_likelihood(x, z); };
    for (std::size_t i = 0; i < n_; ++i) log_likelihoods_[i] = likelihood(states()[i]);
    if (parameters_.improvement == Improvement::pso || parameters_.improvement == Improvement::bat) {
      Rng rng(seed_, stream_id("state_filter.swarm"), step_);
      if (parameters_.improvement == Improvement::pso) {
        swarm_.pso(mutable_states(), log_likelihoods_, likelihood, rng);
      } else {
        swarm_.bat(mutable_states(), log_likelihoods_, likelihood, rng);
      }
    }
    weight();
    resample();
    if (moves()) move(likelihood);
  }

  /// Weighted mean before resampling.
  [[nodiscard]] const State& mean() const { return mean_; }
  /// 1 / sum w^2 before resampling.
  [[nodiscard]] double effective_sample_size() const { return effective_; }
  /// Particles as they go on.
  [[nodiscard]] States states() const { return {states_.data(), n_, Model::kDimension, Model::kAngles}; }
  /// How often all likelihoods were 0 (or not a number); all weights are taken as equal then.
  [[nodiscard]] std::int64_t collapses() const { return collapses_; }

 private:
  [[nodiscard]] bool moves() const {
    return parameters_.improvement == Improvement::resample_move ||
           parameters_.improvement == Improvement::apf_resample_move;
  }
  MutableStates mutable_states() { return {states_.data(), n_, Model::kDimension, Model::kAngles}; }

  void predict() {
    Rng rng(seed_, stream_id("state_filter.motion"), step_);
    const auto motion = model_.motion(static_cast<int>(step_));
    const State sd = model_.noise_sd();
    for (std::size_t i = 0; i < n_; ++i) {
      double* const mean = means_.data() + i * kDimension;
      motion(states()[i], mean);
      for (std::size_t k = 0; k < kDimension; ++k) states_[i * kDimension + k] = mean[k] + sd[k] * rng.normal();
    }
    wrap_all();
  }

  void weight() {
    double largest = -std::numeric_limits<double>::infinity();
    for (const double v : log_likelihoods_) largest = v > largest ? v : largest;
    if (!std::isfinite(largest)) {
      ++collapses_;
      std::ranges::fill(log_likelihoods_, largest = 0.0);
    }
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < n_; ++i) {
      const double w = carried_[i] * std::exp(log_likelihoods_[i] - largest);
      weights_[i] = w >= 0.0 ? w : 0.0;  // a likelihood that is not a number counts as none
      sum += weights_[i];
      squares += weights_[i] * weights_[i];
    }
    effective_ = sum * sum / squares;
    average(sum);
  }

  void average(double total) {
    for (std::size_t k = 0; k < kDimension; ++k) {
      double sum = 0.0, cosine = 0.0, sine = 0.0;
      for (std::size_t i = 0; i < n_; ++i) {
        const double x = states_[i * kDimension + k];
        if (is_angle(k)) {
          cosine += weights_[i] * std::cos(x);
          sine += weights_[i] * std::sin(x);
        } else {
          sum += weights_[i] * x;
        }
      }
      mean_[k] = is_angle(k) ? std::atan2(sine, cosine) : sum / total;
    }
  }

  void resample() {
    Rng rng(seed_, stream_id("state_filter.resampling"), step_);
    const auto size = static_cast<std::uint32_t>(n_);
    if (parameters_.improvement == Improvement::apf || parameters_.improvement == Improvement::apf_resample_move) {
      resampler_->offspring(weights_, size, rng, counts_);
      const auto moves = apf_.optimise(states(), weights_, counts_, ancestors_, rng);
      copy_survivors();
      for (const MovedParticle& move : moves) apply_move(move, states(), states_.data() + move.slot * kDimension);
      return;
    }
    if (resampler_->equal_weights() || moves()) {
      resampler_->offspring(weights_, size, rng, counts_);
      place_in_slots(counts_, ancestors_);
    } else {
      resampler_->offspring(weights_, size, rng, counts_, copy_weights_);
      place_in_slots(counts_, ancestors_);
      for (std::size_t i = 0; i < n_; ++i) carried_[i] = copy_weights_[ancestors_[i]] * static_cast<double>(n_);
    }
    if (parameters_.resampling == Resampling::regularised) {
      const Spread before(states(), weights_);
      copy_survivors();
      regularise(before, mutable_states(), rng);
    } else {
      copy_survivors();
    }
  }

  /// Survivors keep their slots, so that none is overwritten before it is copied.
  void copy_survivors() {
    for (std::size_t i = 0; i < n_; ++i) {
      if (ancestors_[i] == i) continue;
      std::copy_n(states()[ancestors_[i]], kDimension, states_.data() + i * kDimension);
      std::copy_n(means_.data() + ancestors_[i] * kDimension, kDimension, means_.data() + i * kDimension);
    }
  }

  template <class Likelihood>
  void move(const Likelihood& likelihood) {
    Rng rng(seed_, stream_id("state_filter.moves"), step_);
    State precision = model_.noise_sd();
    for (double& v : precision) v = 1.0 / (v * v);
    const auto target = [&](std::size_t i, const double* x) {
      double sum = 0.0;
      for (std::size_t k = 0; k < kDimension; ++k) {
        const double d = x[k] - means_[i * kDimension + k], e = is_angle(k) ? wrap(d) : d;
        sum += precision[k] * e * e;
      }
      return likelihood(x) - 0.5 * sum;
    };
    particle::resample_move(mutable_states(), target, parameters_.moves, rng);
  }

  static constexpr bool is_angle(std::size_t k) { return ((Model::kAngles >> k) & 1u) != 0; }
  void wrap_all() {
    if constexpr (Model::kAngles != 0) {
      for (std::size_t i = 0; i < states_.size(); ++i) {
        if (is_angle(i % kDimension)) states_[i] = wrap(states_[i]);
      }
    }
  }

  Model model_;
  StateFilterParameters parameters_;
  std::uint64_t seed_;
  std::unique_ptr<const Resampler> resampler_;
  Swarm swarm_;
  Apf apf_;
  std::size_t n_;
  std::uint64_t step_ = 0;
  std::vector<double> states_, means_;  ///< the latter: predictions that the states were drawn around
  std::vector<double> log_likelihoods_, carried_, weights_, copy_weights_;
  std::vector<std::uint32_t> counts_, ancestors_;
  State mean_{};
  double effective_ = 0.0;
  std::int64_t collapses_ = 0;
};

}  // namespace noctule::particle
