#pragma once
/// The chi-square distribution, for gates and consistency bounds.

namespace noctule {

/// P(X <= x) for X chi-square with `dof` degrees of freedom (any positive number).
[[nodiscard]] double chi2_cdf(double x, double dof);

/// The x with chi2_cdf(x, dof) = probability. Throws std::domain_error unless 0 < probability < 1 and dof > 0.
[[nodiscard]] double chi2_quantile(double probability, double dof);

/// Interval that the average of `samples` independent NEES/NIS values of dimension `dimension` lies in with the given
/// probability when the estimator is consistent (Bar-Shalom, Li, Kirubarajan, section 5.4).
struct Interval {
  double low;
  double high;
};
[[nodiscard]] Interval nees_bounds(int dimension, int samples, double probability = 0.95);

}  // namespace noctule
