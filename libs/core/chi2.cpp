#include "core/chi2.hpp"

#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/SpecialFunctions>

namespace noctule {

double chi2_cdf(double x, double dof) {
  if (!(dof > 0.0)) throw std::domain_error("chi2: degrees of freedom must be positive");
  return x <= 0.0 ? 0.0 : Eigen::numext::igamma(0.5 * dof, 0.5 * x);
}

double chi2_quantile(double probability, double dof) {
  if (!(probability > 0.0 && probability < 1.0)) throw std::domain_error("chi2: probability must be in (0, 1)");
  double low = 0.0, high = dof + 10.0;
  while (chi2_cdf(high, dof) < probability) high *= 2.0;
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (chi2_cdf(middle, dof) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Interval nees_bounds(int dimension, int samples, double probability) {
  const double dof = static_cast<double>(dimension) * samples;
  const double tail = 0.5 * (1.0 - probability);
  return {chi2_quantile(tail, dof) / samples, chi2_quantile(1.0 - tail, dof) / samples};
}

}  // namespace noctule
