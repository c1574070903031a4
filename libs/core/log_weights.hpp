#pragma once
/// Weights of particles and hypotheses in the log domain: products of likelihoods underflow, sums of logs do not.
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace noctule {

/// log(sum exp(a_i)); -inf for an empty span or when every a_i is -inf.
[[nodiscard]] inline double log_sum_exp(std::span<const double> a) {
  double max = -std::numeric_limits<double>::infinity();
  for (const double v : a) max = v > max ? v : max;
  if (max == -std::numeric_limits<double>::infinity()) return max;
  double sum = 0.0;
  for (const double v : a) sum += std::exp(v - max);
  return max + std::log(sum);
}

/// log(exp(a) + exp(b)).
[[nodiscard]] inline double log_add_exp(double a, double b) {
  if (a < b) std::swap(a, b);
  if (b == -std::numeric_limits<double>::infinity()) return a;
  return a + std::log1p(std::exp(b - a));
}

/// Makes log weights sum to one (log_sum_exp = 0) and returns the log of the sum they had. When the total likelihood
/// has collapsed (all -inf) or is not a number, the weights become uniform and the return value is -inf: the caller
/// counts and reports that event.
inline double normalise_log_weights(std::span<double> log_weights) {
  const double total = log_sum_exp(log_weights);
  if (!std::isfinite(total)) {
    const double uniform = -std::log(static_cast<double>(log_weights.size()));
    for (double& v : log_weights) v = uniform;
    return -std::numeric_limits<double>::infinity();
  }
  for (double& v : log_weights) v -= total;
  return total;
}

/// 1 / sum w^2 of normalised log weights, in [1, N].
[[nodiscard]] inline double effective_sample_size(std::span<const double> log_weights) {
  double sum = 0.0;
  for (const double v : log_weights) sum += std::exp(2.0 * v);
  return sum > 0.0 ? 1.0 / sum : 0.0;
}

/// Perplexity exp(-sum w log w) of normalised log weights, in [1, N].
[[nodiscard]] inline double perplexity(std::span<const double> log_weights) {
  double entropy = 0.0;
  for (const double v : log_weights) {
    if (v > -700.0) entropy -= v * std::exp(v);
  }
  return std::exp(entropy);
}

}  // namespace noctule
