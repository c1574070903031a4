#pragma once
/// What an experiment will run, checked before the first run.
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace noctule::experiment {

/// A scenario and what of the experiment it can take.
struct PlannedScenario {
  std::string name;
  std::unique_ptr<Scenario> scenario;
  std::vector<FilterSpec> filters;   ///< single ones, in the order of the file
  std::vector<std::string> metrics;  ///< that are kept
  std::vector<std::string> dropped;  ///< that are measured too
};

/// One seed of one scenario, for all its filters.
struct Piece {
  std::size_t scenario = 0;
  std::uint64_t seed = 0;
};

struct Plan {
  Experiment experiment;
  std::vector<PlannedScenario> scenarios;
  std::vector<Piece> pieces;  ///< scenario by scenario, seeds ascending
  /// Number of runs of a filter.
  [[nodiscard]] std::size_t runs() const;
};

using ScenarioFactory = std::function<std::unique_ptr<Scenario>(const ScenarioSpec&)>;

/// A filter goes to the scenarios that can take it.
/// \throws InputError when no scenario can take a filter or measure a metric (naming those they can), when a scenario
/// can take no filter of the list, and for what is wrong in any configuration
[[nodiscard]] Plan make_plan(const Experiment&, const ScenarioFactory& factory = make_scenario);

}  // namespace noctule::experiment
