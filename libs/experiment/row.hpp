#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "eval/metrics.hpp"

namespace noctule::experiment {

/// One figure of one run; a line of runs.csv.
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

/// A metric over time: the same times for every seed and filter of a scenario.
struct Series {
  std::string metric;
  std::string unit;            ///< SI
  std::vector<double> time;    ///< [s], increasing
  std::vector<double> values;  ///< one per time; NaN: could not be measured then
};

/// What one filter made of one seed.
struct FilterRun {
  std::vector<eval::Metric> figures;  ///< depend on seed and parameters alone: no time of computing among them
  std::vector<eval::Metric> timings;  ///< depend on the machine: `cpu_per_scan`, `peak_memory` ...
  std::vector<Series> series;         ///< for plots against time; may be empty
  bool diverged = false;
};

}  // namespace noctule::experiment
