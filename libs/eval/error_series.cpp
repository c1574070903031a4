#include "eval/error_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "eval/statistics.hpp"

namespace noctule::eval {

ErrorStatistics error_statistics(std::span<const double> errors) {
  ErrorStatistics s;
  if (errors.empty()) {
    s.rmse = s.mean = s.median = s.sd = s.min = s.max = std::numeric_limits<double>::quiet_NaN();
    return s;
  }
  s.samples = static_cast<int>(errors.size());
  s.mean = mean(errors);
  double squares = 0.0, deviations = 0.0;
  for (const double e : errors) {
    squares += e * e;
    deviations += (e - s.mean) * (e - s.mean);
  }
  s.rmse = std::sqrt(squares / s.samples);
  s.sd = std::sqrt(deviations / s.samples);
  s.median = quantile(errors, 0.5);
  s.min = *std::ranges::min_element(errors);
  s.max = *std::ranges::max_element(errors);
  return s;
}

std::vector<double> rmse_over_runs(std::span<const std::vector<double>> runs) {
  std::vector<double> squares;
  std::vector<int> counts;
  for (const std::vector<double>& run : runs) {
    squares.resize(std::max(squares.size(), run.size()), 0.0);
    counts.resize(squares.size(), 0);
    for (std::size_t k = 0; k < run.size(); ++k) {
      if (!std::isfinite(run[k])) throw std::invalid_argument("rmse over runs: an error is not finite");
      squares[k] += run[k] * run[k];
      ++counts[k];
    }
  }
  for (std::size_t k = 0; k < squares.size(); ++k) squares[k] = std::sqrt(squares[k] / counts[k]);
  return squares;
}

}  // namespace noctule::eval
