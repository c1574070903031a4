#pragma once
/// What a filter may believe of its measurement noise: fixed, or learned on the way as a Gaussian mixture.
#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include "core/parameters.hpp"

namespace noctule::filters {

/// The nominal noise, for ever.
struct FixedNoiseParameters {
  template <class Visitor>
  static void describe(Visitor&) {}
};

/// Components that learned noise begins with and how fast it forgets.
struct NoiseLearningParameters {
  int components = 2;
  double sd_ratio = 4.0;  ///< of each component at first to the one before; the first has the nominal sd
  double memory = 50.0;   ///< a scan of n observations keeps 1 - n / memory of what was known ...
  double keep_at_least = 0.8;
  double keep_at_most = 0.995;  ///< ... within these
  int iterations = 4;           ///< of the posterior per scan

  /// Variance of component l at first, in units of the nominal one.
  [[nodiscard]] double first_variance(std::size_t l) const { return std::pow(sd_ratio, 2.0 * static_cast<double>(l)); }
  /// Share of the old knowledge that remains when a scan of so many observations comes.
  [[nodiscard]] double keep(double observations) const {
    return std::min(std::max(1.0 - observations / memory, keep_at_least), keep_at_most);
  }

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = NoiseLearningParameters;
    v.field("components", &P::components, unit::one, "normal distributions in the mixture", between(1, 4));
    v.field("sd_ratio", &P::sd_ratio, unit::one,
            "sd of each component at first over that of the one before; the first has the nominal sd", at_least(1.0));
    v.field("memory", &P::memory, unit::one, "a scan of n observations keeps 1 - n / memory of what was known ...",
            positive());
    v.field("keep_at_least", &P::keep_at_least, unit::one, "... but no less than this",
            Range{.min = 0.0, .max = 1.0, .max_allowed = false});
    v.field("keep_at_most", &P::keep_at_most, unit::one, "... and no more than this",
            Range{.min = 0.0, .max = 1.0, .max_allowed = false});
    v.field("iterations", &P::iterations, unit::one, "of the posterior per scan", Range{.min = 1, .max = 1000});
  }
  [[nodiscard]] std::string validate() const {
    return keep_at_most < keep_at_least ? "keep_at_most must not be below keep_at_least" : "";
  }
};

/// Point estimates by recursive expectation maximisation (Yuan et al.'s EM-PF).
struct EmNoiseParameters {
  NoiseLearningParameters learning;
  double variance_floor = 0.01;  ///< added to each component's variance, in units of the nominal one

  template <class Visitor>
  static void describe(Visitor& v) {
    v.group("learning", &EmNoiseParameters::learning, "components and forgetting");
    v.field("variance_floor", &EmNoiseParameters::variance_floor, unit::one,
            "added to the variance of each component, in units of the nominal one", positive());
  }
};

/// Variational Bayes with Dirichlet and Normal-Wishart priors. The prior is also what knowledge is forgotten towards.
struct VbNoiseParameters {
  NoiseLearningParameters learning;
  double alpha = 1.0;   ///< Dirichlet: prior observations of each component
  double beta = 200.0;  ///< prior observations of a component's mean, which is 0; large: the noise has no bias
  double nu = 6.0;      ///< Wishart: prior observations of a component's variance

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = VbNoiseParameters;
    v.group("learning", &P::learning, "components and forgetting");
    v.field("alpha", &P::alpha, unit::one, "prior observations of each component's weight", positive());
    v.field("beta", &P::beta, unit::one, "prior observations of each component's mean, which is 0", positive());
    v.field("nu", &P::nu, unit::one, "prior observations of each component's variance", Range{.min = 4.0});
  }
};

using NoiseParameters = std::variant<FixedNoiseParameters, EmNoiseParameters, VbNoiseParameters>;

}  // namespace noctule::filters
