#include "particle/weights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/log_weights.hpp"

namespace noctule::particle {

Weights::Weights(std::size_t size) : log_(size) {
  if (size == 0) throw std::invalid_argument("weights: at least one particle is needed");
  make_uniform();
}

double Weights::multiply(std::span<const double> log_likelihoods) {
  if (log_likelihoods.size() != log_.size()) throw std::invalid_argument("weights: one likelihood per particle needed");
  for (const double v : log_likelihoods) {
    if (std::isnan(v) || v == std::numeric_limits<double>::infinity()) {
      throw std::domain_error("weights: a log likelihood is NaN or +inf");
    }
  }
  for (std::size_t i = 0; i < log_.size(); ++i) log_[i] += log_likelihoods[i];
  const double evidence = normalise_log_weights(log_);
  if (!std::isfinite(evidence)) ++collapses_;
  return evidence;
}

void Weights::make_uniform() {
  std::ranges::fill(log_, -std::log(static_cast<double>(log_.size())));
}

void Weights::inherit(std::span<const std::uint32_t> ancestors, std::span<const double> copy_weights) {
  if (ancestors.empty()) throw std::invalid_argument("weights: at least one particle is needed");
  log_.resize(ancestors.size());
  std::ranges::transform(ancestors, log_.begin(), [&](std::uint32_t a) { return std::log(copy_weights[a]); });
  normalise_log_weights(log_);
}

std::vector<double> Weights::linear() const {
  std::vector<double> w(log_.size());
  std::ranges::transform(log_, w.begin(), [](double v) { return std::exp(v); });
  return w;
}

double Weights::effective_sample_size() const {
  return noctule::effective_sample_size(log_);
}

}  // namespace noctule::particle
