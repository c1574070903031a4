#include "experiment/plan.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace noctule::experiment {
namespace {

using Names = std::vector<std::string>;

bool contains(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string list_of(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// "; heptagon knows: pf, known_pose; growth_q10 knows: ..."
std::string known(const std::vector<PlannedScenario>& scenarios, Names (Scenario::*names)() const) {
  std::string text;
  for (const PlannedScenario& s : scenarios) text += "; " + s.name + " knows: " + list_of((*s.scenario.*names)());
  return text;
}

void plan_filters(const Experiment& experiment, std::vector<PlannedScenario>& scenarios) {
  for (const FilterSpec& filter : expand(experiment.filters)) {
    bool taken = false;
    for (PlannedScenario& s : scenarios) {
      if (!contains(s.scenario->filters(), filter.name)) continue;
      s.scenario->check(filter);
      s.filters.push_back(filter);
      taken = true;
    }
    if (!taken) {
      throw InputError("filters: no scenario can take '" + filter.name + "'" + known(scenarios, &Scenario::filters));
    }
  }
  for (const PlannedScenario& s : scenarios) {
    if (s.filters.empty()) {
      throw InputError("scenario '" + s.name +
                       "': no filter of the list can run there; it knows: " + list_of(s.scenario->filters()));
    }
  }
}

void plan_metrics(const Experiment& experiment, std::vector<PlannedScenario>& scenarios) {
  for (const std::string& metric : experiment.metrics) {
    const bool measured = std::any_of(scenarios.begin(), scenarios.end(), [&](const PlannedScenario& s) {
      return contains(s.scenario->metrics(), metric);
    });
    if (!measured) {
      throw InputError("metrics: no scenario measures '" + metric + "'" + known(scenarios, &Scenario::metrics));
    }
  }
  for (PlannedScenario& s : scenarios) {
    s.metrics = s.scenario->metrics();
    if (experiment.metrics.empty()) continue;
    const auto wanted = [&](const std::string& metric) { return contains(experiment.metrics, metric); };
    const auto unwanted = std::stable_partition(s.metrics.begin(), s.metrics.end(), wanted);
    s.dropped.assign(unwanted, s.metrics.end());
    s.metrics.erase(unwanted, s.metrics.end());
    if (s.metrics.empty()) {
      throw InputError("scenario '" + s.name +
                       "': measures no metric of the list; it knows: " + list_of(s.scenario->metrics()));
    }
  }
  for (const std::string& metric : experiment.plots) {
    const bool kept = std::any_of(scenarios.begin(), scenarios.end(),
                                  [&](const PlannedScenario& s) { return contains(s.metrics, metric); });
    if (!kept) throw InputError("plots: no scenario keeps the metric '" + metric + "'");
  }
}

}  // namespace

std::size_t Plan::runs() const {
  std::size_t count = 0;
  for (const Piece& piece : pieces) count += scenarios[piece.scenario].filters.size();
  return count;
}

Plan make_plan(const Experiment& experiment, const ScenarioFactory& factory) {
  Plan plan{experiment, {}, {}};
  for (const ScenarioSpec& spec : experiment.scenarios)
    plan.scenarios.push_back({spec.name, factory(spec), {}, {}, {}});
  plan_filters(experiment, plan.scenarios);
  plan_metrics(experiment, plan.scenarios);
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    for (std::uint64_t seed = experiment.first_seed; seed <= experiment.last_seed; ++seed) {
      plan.pieces.push_back({s, seed});
    }
  }
  return plan;
}

}  // namespace noctule::experiment
