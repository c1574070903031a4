#pragma once
/// The weights of a set of particles.
#include <cstdint>
#include <span>
#include <vector>

#include "core/state_archive.hpp"

namespace noctule::particle {

/// N log weights that always sum to one.
class Weights {
 public:
  /// Uniform. \throws std::invalid_argument when size is 0
  explicit Weights(std::size_t size);

  /// Multiplies the weights by N likelihoods given as logs (-inf allowed) and normalises. When nothing is left of them
  /// they become uniform and collapses() grows.
  /// \return log of the weighted mean likelihood, -inf after a collapse
  /// \throws std::domain_error on a likelihood that is NaN or +inf; the weights stay as they were
  double multiply(std::span<const double> log_likelihoods);

  /// All 1/N, as after resampling.
  void make_uniform();
  /// Takes N log weights, not necessarily normalised. \throws std::domain_error when one is NaN or +inf, or all are
  /// -inf
  void assign(std::span<const double> log_weights);

  [[nodiscard]] std::span<const double> log() const { return log_; }
  /// The N weights themselves, sum 1.
  [[nodiscard]] std::vector<double> linear() const;
  void linear(std::span<double> weights) const;
  /// 1 / sum w^2, in [1, N].
  [[nodiscard]] double effective_sample_size() const;
  /// How often all likelihoods were 0 so far.
  [[nodiscard]] std::int64_t collapses() const { return collapses_; }

  void transfer(StateArchive& archive) { archive(log_, collapses_); }

 private:
  void check(std::span<const double> logs) const;

  std::vector<double> log_;
  std::int64_t collapses_ = 0;
};

}  // namespace noctule::particle
