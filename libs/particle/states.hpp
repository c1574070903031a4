#pragma once
/// States of particles as plain numbers, for methods that look at where the particles are.
#include <array>
#include <cstdint>
#include <span>

#include "core/rng.hpp"

namespace noctule::particle {

/// N states of `dimension` numbers each, side by side in memory that belongs to somebody else. A set bit k of `angles`
/// says that coordinate k is an angle [rad].
template <class Number>
struct BasicStates {
  Number* values = nullptr;
  std::size_t size = 0;
  int dimension = 1;
  std::uint32_t angles = 0;

  [[nodiscard]] Number* operator[](std::size_t i) const { return values + i * static_cast<std::size_t>(dimension); }
  [[nodiscard]] bool is_angle(int k) const { return ((angles >> k) & 1u) != 0; }
  operator BasicStates<const Number>() const { return {values, size, dimension, angles}; }
};
using States = BasicStates<const double>;
using MutableStates = BasicStates<double>;

inline constexpr int kMaxDimension = 16;

/// Weighted mean and covariance of states. Differences of angles are wrapped; their mean is that of their offsets where
/// these stay within a right angle, else the circular one.
class Spread {
 public:
  /// \param weights one per state, not necessarily normalised; none: equal ones
  /// \throws std::invalid_argument for no states, a dimension outside [1, kMaxDimension] or weights without a sum
  explicit Spread(States states, std::span<const double> weights = {});

  [[nodiscard]] double mean(int k) const { return mean_[index(k)]; }
  [[nodiscard]] double covariance(int i, int j) const { return covariance_[at(i, j)]; }
  /// All states are equal.
  [[nodiscard]] bool is_point() const { return point_; }
  /// Coordinates about the mean in which the covariance is the identity; 0 of a point. \param[out] y may not be x
  void whiten(const double* x, double* y) const;
  /// L e with L L' = covariance (and a thousand-millionth of its trace, so that a flat one has a root, too).
  void colour(const double* e, double* x) const;

 private:
  static std::size_t index(int k) { return static_cast<std::size_t>(k); }
  static std::size_t at(int i, int j) { return static_cast<std::size_t>(i * kMaxDimension + j); }
  bool add_moments(States states, std::span<const double> weights, double total);
  void set_circular_means(States states, std::span<const double> weights);
  void factorise();

  int dimension_;
  std::uint32_t angles_;
  bool point_ = false, centred_ = false;
  std::array<double, kMaxDimension> mean_{}, inverse_{};  ///< the latter: 1 / diagonal of the factor; 0 of a point
  std::array<double, kMaxDimension * kMaxDimension> covariance_{}, factor_{};
};

/// Regularised resampling, its second half: kernel noise on states that are resampled already, which are drawn toward
/// the mean beforehand so that mean and covariance stay (Liu, West 2001). \param before spread of the weighted states
/// before resampling
void regularise(const Spread& before, MutableStates resampled, Rng& rng);

/// Numbers of offspring by error ellipse: every shell of the states about their mean (inside 50, 90, 99 % of a normal
/// distribution, and beyond) gets its share by SSP, and within it each particle by a comb. E[n_i] = M w_i.
/// \throws std::invalid_argument as Resampler::offspring
void error_ellipse_offspring(States states, std::span<const double> weights, std::uint32_t size, Rng& rng,
                             std::span<std::uint32_t> counts);

/// How many particles a distribution over so many occupied bins needs (Fox 2003, eq. 7).
struct KldParameters {
  double error = 0.05;      ///< bound of the Kullback-Leibler distance
  double quantile = 2.326;  ///< of the normal distribution at the wanted confidence: 99 %
  std::uint32_t least = 10, most = 2000;
};
[[nodiscard]] std::uint32_t kld_size(std::size_t occupied_bins, const KldParameters& parameters);

/// Draws until there are as many particles as the bins they occupy ask for. \param bin_size one per coordinate,
/// positive; angles are binned on the circle \param[out] counts as Resampler::offspring \return M
/// \throws std::invalid_argument as Resampler::offspring, and for bins that are not positive
std::uint32_t kld_offspring(States states, std::span<const double> weights, std::span<const double> bin_size,
                            const KldParameters& parameters, Rng& rng, std::span<std::uint32_t> counts);

}  // namespace noctule::particle
