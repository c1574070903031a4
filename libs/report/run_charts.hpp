#pragma once
#include <vector>

#include "report/chart.hpp"
#include "report/run_data.hpp"

namespace noctule::report {

/// Errors of the pose over time with their three-sigma bounds, beside dead reckoning. Empty without truth.
[[nodiscard]] std::vector<Chart> error_charts(const RunData& data);

/// Effective sample size and distinct particles, NIS, NEES and the noise estimate over time.
[[nodiscard]] std::vector<Chart> health_charts(const RunData& data);

}  // namespace noctule::report
