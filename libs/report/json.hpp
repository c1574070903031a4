#pragma once
/// The run's numbers as JSON: shortest texts that read back exactly, null for what is not finite.
#include <string>
#include <vector>

#include "report/chart.hpp"
#include "report/run_data.hpp"

namespace noctule::report {

/// A list of {"name", "value", "unit"}, one metric a line.
[[nodiscard]] std::string metrics_json(const std::vector<eval::Metric>& metrics);

/// What the page's script needs: metrics, timing and the charts' values (thinned). Safe inside a script element.
[[nodiscard]] std::string page_json(const RunData& data, const std::vector<Chart>& charts);

}  // namespace noctule::report
