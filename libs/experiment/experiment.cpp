#include "experiment/experiment.hpp"

#include <set>
#include <sstream>

#include "core/error.hpp"
#include "experiment/contour_room.hpp"

namespace noctule::experiment {

std::string Experiment::validate() const {
  if (last_seed < first_seed) return "last_seed must not be below first_seed";
  if (scenarios.empty()) return "scenarios must name at least one";
  if (filters.empty()) return "filters must name at least one";
  std::set<std::string> names;
  for (const ScenarioSpec& scenario : scenarios) {
    if (!names.insert(scenario.name).second) return "scenario '" + scenario.name + "' is named twice";
  }
  names.clear();
  for (const FilterSpec& filter : filters) {
    if (!names.insert(filter.name + '(' + filter.parameters + ')').second) {
      return "filter '" + filter.name + "' with parameters '" + filter.parameters + "' is named twice";
    }
  }
  return {};
}

std::unique_ptr<Scenario> make_scenario(const ScenarioSpec& spec) {
  if (spec.kind == "contour_room") return std::make_unique<ContourRoom>(spec);
  throw InputError("scenario '" + spec.name + "': kind: expected contour_room, got '" + spec.kind + "'");
}

std::vector<std::string> assignments(const FilterSpec& filter) {
  std::vector<std::string> result;
  std::istringstream text(filter.parameters);
  for (std::string part; std::getline(text, part, ';');) {
    const auto equals = part.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("filter '" + filter.name + "': parameters: expected key=value;key=value, got '" +
                       filter.parameters + "'");
    }
    // N is what papers call it.
    result.push_back(part.substr(0, equals) == "N" ? "particles" + part.substr(equals) : part);
  }
  return result;
}

}  // namespace noctule::experiment
