#include "particle/states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_set>
#include <vector>

#include "core/angles.hpp"
#include "core/chi2.hpp"
#include "particle/resampling_methods.hpp"

namespace noctule::particle {
namespace {

double checked_total(States states, std::span<const double> weights) {
  if (states.size == 0 || states.dimension < 1 || states.dimension > kMaxDimension) {
    throw std::invalid_argument("states: at least one state, and 1 to 16 coordinates, are needed");
  }
  if (weights.empty()) return static_cast<double>(states.size);
  const double total = weights.size() == states.size ? detail::checked_sum(weights) : 0.0;
  if (!(total > 0.0) || !std::isfinite(total)) {
    throw std::invalid_argument("states: one weight per state is needed, finite, not negative, and not all zero");
  }
  return total;
}

}  // namespace

Spread::Spread(States states, std::span<const double> weights) : dimension_(states.dimension), angles_(states.angles) {
  const double total = checked_total(states, weights);
  // Offsets from one of the states are small numbers, and no angle among them is cut in two.
  std::copy_n(states[0], dimension_, mean_.begin());
  if (!add_moments(states, weights, total)) {
    set_circular_means(states, weights);
    add_moments(states, weights, total);
  }
  for (int k = 0; k < dimension_; ++k) {
    for (int l = 0; l < k; ++l) covariance_[at(l, k)] = covariance_[at(k, l)];
  }
  factorise();
}

/// Mean and covariance from offsets about mean_; angles keep their mean_ when they are centred there already.
/// \return whether all offsets of angles are below a right angle, so that their mean is the circular one
bool Spread::add_moments(States states, std::span<const double> weights, double total) {
  std::array<double, kMaxDimension> d{}, first{};
  covariance_.fill(0.0);
  double farthest = 0.0;
  for (std::size_t i = 0; i < states.size; ++i) {
    const double w = weights.empty() ? 1.0 : weights[i];
    for (int k = 0; k < dimension_; ++k) {
      double offset = states[i][k] - mean(k);
      if (states.is_angle(k)) {
        if (std::abs(offset) >= kPi) offset = wrap(offset);
        farthest = std::max(farthest, std::abs(offset));
      }
      d[index(k)] = offset;
      first[index(k)] += w * offset;
      for (int l = 0; l <= k; ++l) covariance_[at(k, l)] += w * offset * d[index(l)];
    }
  }
  if (farthest > 0.5 * kPi && !centred_) return false;
  for (int k = 0; k < dimension_; ++k) first[index(k)] /= total;
  for (int k = 0; k < dimension_; ++k) {
    for (int l = 0; l <= k; ++l) {
      double& c = covariance_[at(k, l)];
      c = c / total - first[index(k)] * first[index(l)];
      if (k == l) c = std::max(c, 0.0);
    }
    mean_[index(k)] += first[index(k)];
    if (states.is_angle(k)) mean_[index(k)] = wrap(mean(k));
  }
  return true;
}

void Spread::set_circular_means(States states, std::span<const double> weights) {
  centred_ = true;
  for (int k = 0; k < dimension_; ++k) {
    if (!states.is_angle(k)) continue;
    double cosine = 0.0, sine = 0.0;
    for (std::size_t i = 0; i < states.size; ++i) {
      const double w = weights.empty() ? 1.0 : weights[i];
      cosine += w * std::cos(states[i][k]);
      sine += w * std::sin(states[i][k]);
    }
    mean_[index(k)] = std::atan2(sine, cosine);
  }
}

/// Cholesky of the covariance with a floor on its diagonal.
void Spread::factorise() {
  double trace = 0.0;
  for (int k = 0; k < dimension_; ++k) trace += covariance(k, k);
  point_ = !(trace > 0.0);
  if (point_) return;
  for (int i = 0; i < dimension_; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = covariance(i, j) + (i == j ? 1e-9 * trace : 0.0);
      for (int k = 0; k < j; ++k) sum -= factor_[at(i, k)] * factor_[at(j, k)];
      factor_[at(i, j)] = i == j ? std::sqrt(std::max(sum, 1e-12 * trace)) : sum * inverse_[index(j)];
    }
    inverse_[index(i)] = 1.0 / factor_[at(i, i)];
  }
}

void Spread::whiten(const double* x, double* y) const {
  for (int i = 0; i < dimension_; ++i) {
    double sum = x[i] - mean(i);
    if (((angles_ >> i) & 1u) != 0 && std::abs(sum) >= kPi) sum = wrap(sum);
    for (int k = 0; k < i; ++k) sum -= factor_[at(i, k)] * y[k];
    y[i] = sum * inverse_[index(i)];
  }
}

void Spread::colour(const double* e, double* x) const {
  for (int i = 0; i < dimension_; ++i) {
    x[i] = 0.0;
    for (int k = 0; k <= i; ++k) x[i] += factor_[at(i, k)] * e[k];
  }
}

void regularise(const Spread& before, MutableStates resampled, Rng& rng) {
  // Bandwidth of a normal kernel that is best for a normal distribution (Silverman).
  const double d = resampled.dimension;
  const double h = std::min(1.0, std::pow(4.0 / ((d + 2.0) * static_cast<double>(resampled.size)), 1.0 / (d + 4.0)));
  const double shrink = std::sqrt(1.0 - h * h);
  std::array<double, kMaxDimension> e{}, noise{};
  for (std::size_t i = 0; i < resampled.size; ++i) {
    for (int k = 0; k < resampled.dimension; ++k) e[static_cast<std::size_t>(k)] = rng.normal();
    before.colour(e.data(), noise.data());
    for (int k = 0; k < resampled.dimension; ++k) {
      double& x = resampled[i][k];
      const double offset = resampled.is_angle(k) ? wrap(x - before.mean(k)) : x - before.mean(k);
      x = before.mean(k) + shrink * offset + h * noise[static_cast<std::size_t>(k)];
      if (resampled.is_angle(k)) x = wrap(x);
    }
  }
}

void error_ellipse_offspring(States states, std::span<const double> weights, std::uint32_t size, Rng& rng,
                             std::span<std::uint32_t> counts) {
  const Spread spread(states, weights);
  if (counts.size() != weights.size()) throw std::invalid_argument("error ellipse: as many counts as weights needed");
  const std::array<double, 3> bounds{chi2_quantile(0.5, states.dimension), chi2_quantile(0.9, states.dimension),
                                     chi2_quantile(0.99, states.dimension)};
  std::array<double, 4> masses{};
  std::array<std::uint32_t, 4> shares{};
  std::vector<std::size_t> shell(states.size);
  std::array<double, kMaxDimension> y{};
  for (std::size_t i = 0; i < states.size; ++i) {
    spread.whiten(states[i], y.data());
    double squared = 0.0;
    for (int k = 0; k < states.dimension; ++k)
      squared += y[static_cast<std::size_t>(k)] * y[static_cast<std::size_t>(k)];
    shell[i] = static_cast<std::size_t>(std::ranges::lower_bound(bounds, squared) - bounds.begin());
    masses[shell[i]] += weights[i];
  }
  detail::add_ssp(masses, detail::checked_sum(masses), size, rng, shares);
  std::ranges::fill(counts, 0u);
  std::vector<double> within(states.size);
  for (std::size_t s = 0; s < masses.size(); ++s) {
    if (shares[s] == 0) continue;
    for (std::size_t i = 0; i < states.size; ++i) within[i] = shell[i] == s ? weights[i] : 0.0;
    detail::add_systematic(within, masses[s], shares[s], rng, counts);
  }
}

std::uint32_t kld_size(std::size_t occupied_bins, const KldParameters& p) {
  if (occupied_bins <= 1) return p.least;
  const double k = static_cast<double>(occupied_bins) - 1.0, a = 2.0 / (9.0 * k);
  const double n = k / (2.0 * p.error) * std::pow(1.0 - a + std::sqrt(a) * p.quantile, 3);
  return static_cast<std::uint32_t>(
      std::clamp(std::ceil(n), static_cast<double>(p.least), static_cast<double>(p.most)));
}

std::uint32_t kld_offspring(States states, std::span<const double> weights, std::span<const double> bin_size,
                            const KldParameters& parameters, Rng& rng, std::span<std::uint32_t> counts) {
  static_cast<void>(checked_total(states, weights));
  if (weights.size() != states.size || counts.size() != weights.size()) {
    throw std::invalid_argument("kld: one weight and one count per state are needed");
  }
  const bool sound = bin_size.size() == static_cast<std::size_t>(states.dimension) &&
                     std::ranges::all_of(bin_size, [](double b) { return b > 0.0; });
  if (!sound) throw std::invalid_argument("kld: one positive bin size per coordinate is needed");
  std::vector<double> cumulative(weights.size());
  double total = 0.0;
  std::ranges::transform(weights, cumulative.begin(), [&](double w) { return total += w; });
  std::ranges::fill(counts, 0u);
  std::unordered_set<std::uint64_t> occupied;
  std::uint32_t drawn = 0, wanted = parameters.least;
  for (; drawn < wanted; ++drawn) {
    const auto i =
        static_cast<std::size_t>(std::ranges::upper_bound(cumulative, rng.uniform() * total) - cumulative.begin());
    const std::size_t chosen = std::min(i, detail::last_positive(weights));
    ++counts[chosen];
    std::uint64_t bin = 0;
    for (int k = 0; k < states.dimension; ++k) {
      const double x = states[chosen][k];
      const auto cell = static_cast<std::int64_t>(
          std::floor((states.is_angle(k) ? wrap(x) : x) / bin_size[static_cast<std::size_t>(k)]));
      bin = splitmix64(bin ^ static_cast<std::uint64_t>(cell));
    }
    if (occupied.insert(bin).second) wanted = std::max(wanted, kld_size(occupied.size(), parameters));
  }
  return drawn;
}

}  // namespace noctule::particle
