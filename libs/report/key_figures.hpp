#pragma once
#include <string>

#include "report/run_data.hpp"

namespace noctule::report {

/// The handful of figures that say how the run went, each on a scale between its limit (known poses) and dead
/// reckoning where these are known.
[[nodiscard]] std::string key_figures(const RunData& data);

}  // namespace noctule::report
