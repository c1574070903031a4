#pragma once
/// The plots of a report: each metric against every number that filters sweep over, against time and against the time
/// of computing, with the published points and the lines to see them by.
#include <string>
#include <vector>

#include "experiment/results.hpp"
#include "report/plot.hpp"

namespace noctule::experiment {

[[nodiscard]] std::vector<report::Plot> parameter_plots(const Results&, const std::string& scenario);
/// One for each series and each value of what is swept over.
[[nodiscard]] std::vector<report::Plot> time_plots(const Results&, const std::string& scenario);
/// Against the first timing whose name begins with `cpu_`; none where there is none.
[[nodiscard]] std::vector<report::Plot> cost_plots(const Results&, const std::string& scenario);

}  // namespace noctule::experiment
