#pragma once
/// Swarms on particles: PSO-PF and BAT-PF as published, what is sound of them, and moves that leave the posterior as it
/// is. A likelihood is any callable double(const double* state), a target any double(std::size_t particle, const
/// double* state); both in the log domain.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "core/angles.hpp"
#include "core/parameters.hpp"
#include "particle/kd_tree.hpp"
#include "particle/states.hpp"

namespace noctule::particle {

enum class SwarmVariant : std::int8_t {
  local,      ///< the lighter half tries steps toward the nearest of the heavier half, and keeps those that pay
  literature  ///< all go toward the one of greatest likelihood: ruins a posterior of several modes
};

struct SwarmParameters {
  SwarmVariant variant = SwarmVariant::local;
  int iterations = 3;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.choice("variant", &SwarmParameters::variant,
             {{"local", SwarmVariant::local}, {"literature", SwarmVariant::literature}},
             "toward the nearest good particle, or all toward the best one");
    v.field("iterations", &SwarmParameters::iterations, unit::one, "steps of the swarm at each measurement",
            between(1, 1000));
  }
};

/// x + gain (toward - x), angles the short way.
inline void step_toward(States s, const double* x, const double* toward, double gain, double* result) {
  for (int k = 0; k < s.dimension; ++k) {
    const double way = toward[k] - x[k];
    result[k] = s.is_angle(k) ? wrap(x[k] + gain * wrap(way)) : x[k] + gain * way;
  }
}

/// Standard deviations of the coordinates.
inline std::array<double, kMaxDimension> deviations(const Spread& spread, int dimension) {
  std::array<double, kMaxDimension> sd{};
  for (int k = 0; k < dimension; ++k) sd[static_cast<std::size_t>(k)] = std::sqrt(spread.covariance(k, k));
  return sd;
}

/// Moves particles toward likely places before they are weighted. The moves follow the likelihood and no importance
/// weight answers for them: the result is biased toward it, little with the local variant.
class Swarm {
 public:
  explicit Swarm(const SwarmParameters& parameters = {}) : parameters_(parameters) {}

  /// Particle swarm. \param[in,out] fitness log likelihoods of the states
  template <class LogLikelihood>
  void pso(MutableStates states, std::span<double> fitness, const LogLikelihood& likelihood, Rng& rng) {
    if (states.size < 2) return;
    if (parameters_.variant == SwarmVariant::local) {
      local_moves(states, fitness, likelihood, [&](const double* x, const double* good, double* candidate) {
        step_toward(states, x, good, rng.uniform(), candidate);
      });
    } else {
      global_pso(states, fitness, likelihood, rng);
    }
  }

  /// Bat algorithm (Yang 2010). \param[in,out] fitness log likelihoods of the states
  template <class LogLikelihood>
  void bat(MutableStates states, std::span<double> fitness, const LogLikelihood& likelihood, Rng& rng) {
    if (states.size < 2) return;
    const auto sd = deviations(Spread(states), states.dimension);
    if (parameters_.variant == SwarmVariant::local) {
      local_moves(states, fitness, likelihood, [&](const double* x, const double* good, double* candidate) {
        step_toward(states, x, good, 2.0 * rng.uniform(), candidate);
        for (int k = 0; k < states.dimension; ++k) candidate[k] += 0.3 * sd[static_cast<std::size_t>(k)] * rng.normal();
      });
    } else {
      global_bat(states, fitness, likelihood, sd, rng);
    }
  }

 private:
  template <class LogLikelihood, class Propose>
  void local_moves(MutableStates states, std::span<double> fitness, const LogLikelihood& likelihood,
                   const Propose& propose) {
    order_.resize(states.size);
    std::iota(order_.begin(), order_.end(), 0u);
    const std::size_t half = states.size / 2;  // lighter ones first
    std::ranges::nth_element(order_, order_.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [&](std::uint32_t i) { return std::pair(fitness[i], i); });
    const auto dimension = static_cast<std::size_t>(states.dimension);
    const bool scalar = states.dimension == 1 && states.angles == 0;
    const Spread spread(states);
    if (!scalar && spread.is_point()) return;
    const auto place = [&](std::uint32_t i, double* y) {
      scalar ? void(*y = *states[i]) : spread.whiten(states[i], y);
    };
    points_.resize((states.size - half) * dimension);
    for (std::size_t i = half; i < states.size; ++i) place(order_[i], points_.data() + (i - half) * dimension);
    good_.build(points_, states.dimension);
    std::array<double, kMaxDimension> y{}, candidate{};
    for (std::size_t i = 0; i < half; ++i) {
      const std::uint32_t poor = order_[i];
      place(poor, y.data());
      good_.nearest(y.data(), 1, near_);
      const double* const good = states[order_[half + near_.front()]];
      for (int k = 0; k < parameters_.iterations; ++k) {
        propose(states[poor], good, candidate.data());
        accept_if_better(states, fitness, likelihood, poor, candidate.data());
      }
    }
  }

  template <class LogLikelihood>
  static bool accept_if_better(MutableStates states, std::span<double> fitness, const LogLikelihood& likelihood,
                               std::size_t i, const double* candidate) {
    const double found = likelihood(candidate);
    if (!(found > fitness[i])) return false;
    std::copy_n(candidate, states.dimension, states[i]);
    fitness[i] = found;
    return true;
  }

  /// Inertia from 0.9 to 0.4, both gains 1.5, a step at most half a standard deviation (Kennedy, Eberhart; Shi).
  template <class LogLikelihood>
  void global_pso(MutableStates states, std::span<double> fitness, const LogLikelihood& likelihood, Rng& rng) {
    const auto sd = deviations(Spread(states), states.dimension);
    const std::size_t numbers = states.size * static_cast<std::size_t>(states.dimension);
    own_best_.assign(states.values, states.values + numbers);
    own_fitness_.assign(fitness.begin(), fitness.end());
    velocities_.assign(numbers, 0.0);
    const MutableStates own{own_best_.data(), states.size, states.dimension, states.angles};
    const MutableStates velocity{velocities_.data(), states.size, states.dimension, 0};
    std::size_t best = argmax(own_fitness_);
    for (int iteration = 0; iteration < parameters_.iterations; ++iteration) {
      const double inertia = 0.9 - 0.5 * iteration / std::max(parameters_.iterations - 1, 1);
      for (std::size_t i = 0; i < states.size; ++i) {
        for (int k = 0; k < states.dimension; ++k) {
          const double to_own = way(states, k, states[i][k], own[i][k]),
                       to_best = way(states, k, states[i][k], own[best][k]);
          const double limit = 0.5 * sd[static_cast<std::size_t>(k)];
          velocity[i][k] = std::clamp(
              inertia * velocity[i][k] + 1.5 * rng.uniform() * to_own + 1.5 * rng.uniform() * to_best, -limit, limit);
        }
      }
      for (std::size_t i = 0; i < states.size; ++i) {
        for (int k = 0; k < states.dimension; ++k) states[i][k] += velocity[i][k];
        wrap_angles(states, i);
        fitness[i] = likelihood(states[i]);
        accept_own(states, own, fitness[i], i);
      }
      best = argmax(own_fitness_);
    }
  }

  /// Loudness 0.9 falling by a tenth at each success, pulse rate 0.5 (1 - exp(-0.9 t)), frequencies in [0, 1].
  template <class LogLikelihood>
  void global_bat(MutableStates states, std::span<double> fitness, const LogLikelihood& likelihood,
                  const std::array<double, kMaxDimension>& sd, Rng& rng) {
    velocities_.assign(states.size * static_cast<std::size_t>(states.dimension), 0.0);
    loudness_.assign(states.size, 0.9);
    const MutableStates velocity{velocities_.data(), states.size, states.dimension, 0};
    std::array<double, kMaxDimension> candidate{};
    for (int iteration = 1; iteration <= parameters_.iterations; ++iteration) {
      const double pulse_rate = 0.5 * (1.0 - std::exp(-0.9 * iteration));
      const double loudness =
          std::accumulate(loudness_.begin(), loudness_.end(), 0.0) / static_cast<double>(states.size);
      const std::size_t best = argmax(fitness);
      for (std::size_t i = 0; i < states.size; ++i) {
        const double frequency = rng.uniform();
        const bool walks = rng.uniform() > pulse_rate;
        for (int k = 0; k < states.dimension; ++k) {
          const auto at = static_cast<std::size_t>(k);
          velocity[i][k] += frequency * way(states, k, states[i][k], states[best][k]);
          candidate[at] =
              walks ? states[best][k] + rng.uniform(-1.0, 1.0) * loudness * sd[at] : states[i][k] + velocity[i][k];
          if (states.is_angle(k)) candidate[at] = wrap(candidate[at]);
        }
        if (rng.uniform() < loudness_[i] && accept_if_better(states, fitness, likelihood, i, candidate.data())) {
          loudness_[i] *= 0.9;
        }
      }
    }
  }

  void accept_own(MutableStates states, MutableStates own, double fitness, std::size_t i) {
    if (!(fitness > own_fitness_[i])) return;
    own_fitness_[i] = fitness;
    std::copy_n(states[i], states.dimension, own[i]);
  }
  static double way(States s, int k, double from, double to) { return s.is_angle(k) ? wrap(to - from) : to - from; }
  static void wrap_angles(MutableStates states, std::size_t i) {
    for (int k = 0; k < states.dimension; ++k) {
      if (states.is_angle(k)) states[i][k] = wrap(states[i][k]);
    }
  }
  static std::size_t argmax(std::span<const double> v) {
    return static_cast<std::size_t>(std::ranges::max_element(v) - v.begin());
  }

  SwarmParameters parameters_;
  std::vector<std::uint32_t> order_;
  std::vector<double> points_, own_best_, own_fitness_, velocities_, loudness_;
  std::vector<std::uint32_t> near_;
  KdTree good_;
};

struct ResampleMoveParameters {
  int sweeps = 3;
  double jitter = 0.1;  ///< noise of a proposal in standard deviations of the set

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("sweeps", &ResampleMoveParameters::sweeps, unit::one, "proposals for each particle", between(1, 1000));
    v.field("jitter", &ResampleMoveParameters::jitter, unit::one,
            "noise of a proposal in standard deviations of the set", positive());
  }
};

/// Resample-move (Gilks, Berzuini 2001) with steps of differential evolution (ter Braak 2006): x + gamma (x_a - x_b) +
/// noise, gamma = 2.38 / sqrt(2 d), accepted by Metropolis' rule. It leaves the target as it is: a swarm without bias.
/// \param states resampled, of equal weight
/// \param target log density, up to a constant of each particle: likelihood times the transition from its ancestor
template <class LogTarget>
void resample_move(MutableStates states, const LogTarget& target, const ResampleMoveParameters& parameters, Rng& rng) {
  if (states.size < 3) return;
  const auto sd = deviations(Spread(states), states.dimension);
  const double gamma = 2.38 / std::sqrt(2.0 * states.dimension);
  std::array<double, kMaxDimension> candidate{};
  for (std::size_t i = 0; i < states.size; ++i) {
    double current = target(i, static_cast<const double*>(states[i]));
    for (int sweep = 0; sweep < parameters.sweeps; ++sweep) {
      // Two others, not i and not the same.
      auto a = static_cast<std::size_t>(rng.index(states.size - 1)),
           b = static_cast<std::size_t>(rng.index(states.size - 2));
      if (b >= a) ++b;
      if (a >= i) ++a;
      if (b >= i) ++b;
      for (int k = 0; k < states.dimension; ++k) {
        const auto at = static_cast<std::size_t>(k);
        const double difference = states[a][k] - states[b][k];
        candidate[at] = states[i][k] + gamma * (states.is_angle(k) ? wrap(difference) : difference) +
                        parameters.jitter * sd[at] * rng.normal();
        if (states.is_angle(k)) candidate[at] = wrap(candidate[at]);
      }
      const double proposed = target(i, static_cast<const double*>(candidate.data()));
      if (std::log(rng.uniform()) < proposed - current) {
        std::copy_n(candidate.data(), states.dimension, states[i]);
        current = proposed;
      }
    }
  }
}

}  // namespace noctule::particle
