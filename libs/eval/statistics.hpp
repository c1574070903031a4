#pragma once
/// Statistics of figures over independent runs. Every function refuses values that are not finite: a run that diverged
/// is counted by whoever asks, never averaged and never silently dropped.
#include <cstdint>
#include <span>

#include "core/chi2.hpp"

namespace noctule::eval {

/// Arithmetic mean. \throws std::invalid_argument for no values or one that is not finite (all functions here)
[[nodiscard]] double mean(std::span<const double> values);

/// Sample standard deviation (n - 1). NaN for a single value.
[[nodiscard]] double standard_deviation(std::span<const double> values);

/// The value below which a part in [0, 1] of the values lies: linear between the order statistics, the smallest at 0,
/// the largest at 1 (Hyndman and Fan 1996, type 7). By sorting a copy.
[[nodiscard]] double quantile(std::span<const double> values, double part);

/// P(T <= t) and its inverse for Student's t with `dof` degrees of freedom.
[[nodiscard]] double student_t_cdf(double t, double dof);
[[nodiscard]] double student_t_quantile(double probability, double dof);

/// Interval of confidence of the mean by Student's t. NaN ends for a single value.
[[nodiscard]] Interval t_interval(std::span<const double> values, double confidence = 0.95);

/// Interval of confidence of the mean by the percentile bootstrap; equal for equal seeds.
[[nodiscard]] Interval bootstrap_interval(std::span<const double> values, std::uint64_t seed, double confidence = 0.95,
                                          int resamples = 2000);

/// Differences a_i - b_i of runs that shared their random numbers.
struct PairedDifference {
  int n = 0;
  double mean = 0.0;
  double sd = 0.0;              ///< of the differences
  Interval interval{0.0, 0.0};  ///< 95 % by Student's t
  double p_value = 1.0;         ///< two-sided, of "no difference"; NaN for a single pair
  double relative = 0.0;        ///< mean / mean of b
};
/// \throws std::invalid_argument for different lengths as well
[[nodiscard]] PairedDifference paired_difference(std::span<const double> a, std::span<const double> b);

}  // namespace noctule::eval
