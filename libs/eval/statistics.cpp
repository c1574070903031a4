#include "eval/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unsupported/Eigen/SpecialFunctions>
#include <vector>

#include "core/limits.hpp"
#include "core/rng.hpp"

namespace noctule::eval {
namespace {

void check(std::span<const double> values) {
  if (values.empty()) throw std::invalid_argument("statistics of no values");
  for (const double v : values) {
    if (!std::isfinite(v)) throw std::invalid_argument("statistics of a value that is not finite");
  }
}

double quantile_of_sorted(std::span<const double> sorted, double part) {
  const double place = part * static_cast<double>(sorted.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  if (low + 1 >= sorted.size()) return sorted.back();
  return std::lerp(sorted[low], sorted[low + 1], place - static_cast<double>(low));
}

}  // namespace

double mean(std::span<const double> values) {
  check(values);
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double standard_deviation(std::span<const double> values) {
  const double m = mean(values);
  if (values.size() < 2) return kNan;
  double square = 0.0;
  for (const double v : values) square += (v - m) * (v - m);
  return std::sqrt(square / static_cast<double>(values.size() - 1));
}

double quantile(std::span<const double> values, double part) {
  check(values);
  if (!(part >= 0.0 && part <= 1.0)) throw std::invalid_argument("quantile: part must be in [0, 1]");
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  return quantile_of_sorted(sorted, part);
}

double student_t_cdf(double t, double dof) {
  if (!(dof > 0.0)) throw std::domain_error("student_t: degrees of freedom must be positive");
  const double tail = 0.5 * Eigen::numext::betainc(0.5 * dof, 0.5, dof / (dof + t * t));
  return t > 0.0 ? 1.0 - tail : tail;
}

double student_t_quantile(double probability, double dof) {
  if (!(probability > 0.0 && probability < 1.0)) throw std::domain_error("student_t: probability must be in (0, 1)");
  if (probability < 0.5) return -student_t_quantile(1.0 - probability, dof);
  // A table asks for the same one at every row.
  thread_local struct { double probability = 0.0, dof = 0.0, quantile = 0.0; } latest;
  if (latest.probability == probability && latest.dof == dof) return latest.quantile;
  double low = 0.0, high = 2.0;
  while (student_t_cdf(high, dof) < probability) high *= 2.0;
  for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (student_t_cdf(middle, dof) < probability ? low : high) = middle;
  }
  latest = {probability, dof, 0.5 * (low + high)};
  return latest.quantile;
}

Interval t_interval(std::span<const double> values, double confidence) {
  const double m = mean(values);
  if (values.size() < 2) return {kNan, kNan};
  const auto n = static_cast<double>(values.size());
  const double half = student_t_quantile(0.5 + 0.5 * confidence, n - 1.0) * standard_deviation(values) / std::sqrt(n);
  return {m - half, m + half};
}

Interval bootstrap_interval(std::span<const double> values, std::uint64_t seed, double confidence, int resamples) {
  check(values);
  std::vector<double> means(static_cast<std::size_t>(resamples));
  for (std::size_t r = 0; r < means.size(); ++r) {
    Rng rng(seed, stream_id("bootstrap"), r);
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) sum += values[rng.index(values.size())];
    means[r] = sum / static_cast<double>(values.size());
  }
  std::sort(means.begin(), means.end());
  const double tail = 0.5 * (1.0 - confidence);
  return {quantile_of_sorted(means, tail), quantile_of_sorted(means, 1.0 - tail)};
}

PairedDifference paired_difference(std::span<const double> a, std::span<const double> b) {
  if (a.size() != b.size()) throw std::invalid_argument("paired_difference: series differ in length");
  const double reference = mean(b);
  std::vector<double> d(a.begin(), a.end());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] -= b[i];
  PairedDifference result;
  result.n = static_cast<int>(d.size());
  result.mean = mean(d);
  result.sd = standard_deviation(d);
  result.interval = t_interval(d);
  result.relative = result.mean / reference;
  if (result.n < 2) {
    result.p_value = kNan;
  } else if (result.sd > 0.0) {
    const double t = std::abs(result.mean) / (result.sd / std::sqrt(static_cast<double>(result.n)));
    result.p_value = 2.0 * student_t_cdf(-t, result.n - 1.0);
  } else {
    result.p_value = result.mean == 0.0 ? 1.0 : 0.0;
  }
  return result;
}

}  // namespace noctule::eval
