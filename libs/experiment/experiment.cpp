#include "experiment/experiment.hpp"

#include <algorithm>
#include <cctype>
#include <ctime>
#include <fstream>
#include <set>

#include "core/error.hpp"
#include "core/limits.hpp"
#include "experiment/contour_room.hpp"
#include "experiment/csv.hpp"
#include "experiment/growth_model.hpp"
#include "experiment/landmark_world.hpp"
#include "experiment/recorded_landmarks.hpp"
#include "experiment/rfs_scene.hpp"
#include "experiment/visual_tracking.hpp"

namespace noctule::experiment {
namespace {

using config::Tree;

/// Names stand in tables and file names.
constexpr const char* kPlainName = "expected a name of letters, digits, '_', '-' and '.'";
bool is_plain(const std::string& name) {
  return !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return (c < 0x80 && std::isalnum(c) != 0) || c == '_' || c == '-' || c == '.';
  });
}

[[noreturn]] void refuse(const FilterSpec& filter, const config::Place& place, const std::string& text) {
  throw InputError(to_string(place) + ": filter '" + filter.name + "': parameters: " + text);
}

/// `key=value` for every value of one entry.
std::vector<std::string> choices_of(const FilterSpec& filter, const config::Entry& entry) {
  const Tree& value = entry.value;
  const std::span<const Tree> values = value.kind == Tree::Kind::list ? std::span(value.items) : std::span(&value, 1);
  if (values.empty()) refuse(filter, entry.place, entry.key + ": expected at least one value");
  std::vector<std::string> choices;
  for (const Tree& v : values) {
    const bool sound = v.kind == Tree::Kind::scalar && v.text.find_first_of(",;=\n\"") == std::string::npos;
    if (!sound) refuse(filter, v.place, entry.key + ": expected plain values, got " + config::describe(v));
    choices.push_back(entry.key + '=' + v.text);
  }
  return choices;
}

}  // namespace

std::string Experiment::validate() const {
  for (const ScenarioSpec& scenario : scenarios) {
    if (!is_plain(scenario.name)) return "scenario '" + scenario.name + "': " + kPlainName;
  }
  for (const FilterSpec& filter : filters) {
    if (!is_plain(filter.name)) return "filter '" + filter.name + "': " + kPlainName;
  }
  if (last_seed < first_seed) return "last_seed must not be below first_seed";
  if (scenarios.empty()) return "scenarios must name at least one";
  if (filters.empty()) return "filters must name at least one";
  std::set<std::string> names;
  for (const ScenarioSpec& scenario : scenarios) {
    if (!names.insert(scenario.name).second) return "scenario '" + scenario.name + "' is named twice";
  }
  return {};
}

std::unique_ptr<Scenario> make_scenario(const ScenarioSpec& spec) {
  if (spec.kind == "contour_room") return std::make_unique<ContourRoom>(spec);
  if (spec.kind == "growth_model") return std::make_unique<GrowthModelRuns>(spec);
  if (spec.kind == "landmark_world") return std::make_unique<LandmarkWorld>(spec);
  if (spec.kind == "recorded_landmarks") return std::make_unique<RecordedLandmarks>(spec);
  if (spec.kind == "rfs_scene") return std::make_unique<RfsScene>(spec);
  if (spec.kind == "visual_tracking") return std::make_unique<VisualTracking>(spec);
  throw InputError("scenario '" + spec.name +
                   "': kind: expected contour_room, growth_model, landmark_world, recorded_landmarks, rfs_scene or "
                   "visual_tracking, got '" +
                   spec.kind + "'");
}

std::vector<FilterSpec> expand(std::span<const FilterSpec> families) {
  std::vector<FilterSpec> result;
  std::set<std::string> names;
  for (const FilterSpec& family : families) {
    const bool sound = family.sweep.kind == Tree::Kind::map || family.sweep.kind == Tree::Kind::nothing;
    if (!sound) refuse(family, family.sweep.place, "expected a map, got " + config::describe(family.sweep));
    std::vector<std::string> combinations{""};
    for (const config::Entry& entry : family.sweep.entries) {
      std::vector<std::string> longer;
      for (const std::string& head : combinations) {
        for (const std::string& choice : choices_of(family, entry)) {
          longer.push_back(head.empty() ? choice : head + ';' + choice);
        }
      }
      combinations = std::move(longer);
    }
    for (const std::string& parameters : combinations) {
      if (!names.insert(family.name + '(' + parameters + ')').second) {
        throw InputError("filter '" + family.name + "' with parameters '" + parameters + "' is named twice");
      }
      result.push_back({family.name, family.role, family.config, {}, parameters});
    }
  }
  return result;
}

Tree effective_config(const FilterSpec& filter) {
  std::vector<std::string> assignments;
  if (!filter.parameters.empty()) assignments = split(filter.parameters, ';');
  for (std::string& assignment : assignments) {
    if (assignment.starts_with("N=")) assignment.replace(0, 1, "particles");  // N is what papers call it
  }
  return config::override_tree(filter.config, assignments, "filter '" + filter.name + "': parameters: ");
}

bool has_diverged(double final_position_error, double path_length) {
  return !(final_position_error <= std::max(3.0, 0.1 * path_length));  // NaN has
}

double cpu_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0.0;
    if (word == "VmHWM:" && status >> kilobytes) return 1024.0 * kilobytes;
  }
  return kNan;
}

void reset_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << "5";
}

}  // namespace noctule::experiment
