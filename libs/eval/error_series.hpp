#pragma once
/// Series of errors over the time of a run, and over runs.
#include <span>
#include <vector>

namespace noctule::eval {

/// The figures that evo prints of a series; NaN for an empty one.
struct ErrorStatistics {
  int samples = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double sd = 0.0;  ///< of the population (divided by n)
  double min = 0.0;
  double max = 0.0;
};
/// \throws std::invalid_argument for an error that is not finite
[[nodiscard]] ErrorStatistics error_statistics(std::span<const double> errors);

/// Root mean square over runs at each time: the curve of a Monte-Carlo plot.
/// \param runs one series a run, same times in each; runs may end early
/// \throws std::invalid_argument for an error that is not finite
[[nodiscard]] std::vector<double> rmse_over_runs(std::span<const std::vector<double>> runs);

}  // namespace noctule::eval
