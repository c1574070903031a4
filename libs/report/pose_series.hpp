#pragma once
/// Series that more than one part of the report needs.
#include <vector>

#include "report/run_data.hpp"

namespace noctule::report {

/// The poses of `data.estimates`.
[[nodiscard]] std::vector<eval::TimedPose> filter_trajectory(const RunData& data);

/// NEES of each estimate; NaN where there is no truth or no covariance.
[[nodiscard]] std::vector<double> nees_series(const RunData& data);

}  // namespace noctule::report
