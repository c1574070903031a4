#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace noctule::experiment {

/// One figure of one run.
struct Row {
  std::string scenario;
  std::string filter;
  std::string parameters;  ///< `key=value;key=value`, as the experiment file says
  std::uint64_t seed = 0;
  std::string metric;
  std::string unit;       ///< SI
  double value = 0.0;     ///< NaN: could not be measured in this run (kept, and counted in the summary's n)
  bool diverged = false;  ///< of the run
};

/// What one seed of one scenario yields for all filters: the figures that depend on the numbers alone, and apart from
/// them those that depend on the machine.
struct RunRows {
  std::vector<Row> figures;
  std::vector<Row> timings;
};

}  // namespace noctule::experiment
