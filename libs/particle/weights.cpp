#include "particle/weights.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/limits.hpp"
#include "core/log_weights.hpp"

namespace noctule::particle {

Weights::Weights(std::size_t size) : log_(size) {
  if (size == 0) throw std::invalid_argument("weights: at least one particle is needed");
  make_uniform();
}

void Weights::check(std::span<const double> logs) const {
  if (logs.size() != log_.size()) throw std::invalid_argument("weights: one number per particle needed");
  for (const double v : logs) {
    if (std::isnan(v) || v == kInf) {
      throw std::domain_error("weights: a log likelihood is NaN or +inf");
    }
  }
}

double Weights::multiply(std::span<const double> log_likelihoods) {
  check(log_likelihoods);
  for (std::size_t i = 0; i < log_.size(); ++i) log_[i] += log_likelihoods[i];
  const double evidence = normalise_log_weights(log_);
  if (!std::isfinite(evidence)) ++collapses_;
  return evidence;
}

void Weights::make_uniform() {
  std::ranges::fill(log_, -std::log(static_cast<double>(log_.size())));
}

void Weights::assign(std::span<const double> log_weights) {
  check(log_weights);
  if (std::ranges::max(log_weights) == -kInf) {
    throw std::domain_error("weights: all are 0");
  }
  std::ranges::copy(log_weights, log_.begin());
  normalise_log_weights(log_);
}

std::vector<double> Weights::linear() const {
  std::vector<double> w(log_.size());
  linear(w);
  return w;
}

void Weights::linear(std::span<double> weights) const {
  std::ranges::transform(log_, weights.begin(), [](double v) { return std::exp(v); });
}

double Weights::effective_sample_size() const {
  return noctule::effective_sample_size(log_);
}

}  // namespace noctule::particle
