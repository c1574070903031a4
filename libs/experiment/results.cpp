#include "experiment/results.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "config/config.hpp"
#include "core/error.hpp"
#include "experiment/csv.hpp"

namespace noctule::experiment {
namespace {

/// Rows of one metric of one filter in one scenario.
struct Group {
  Subject subject;
  std::string metric;
  std::vector<Row> rows;
};

/// In the order of first appearance.
std::vector<Group> group(std::span<const Row> rows, const Selection& selection) {
  std::vector<Group> groups;
  std::map<std::pair<Subject, std::string>, std::size_t> index;
  for (const Row& row : rows) {
    if (!selection.filter.empty() && row.filter != selection.filter) continue;
    if (selection.parameters && row.parameters != *selection.parameters) continue;
    const Subject subject{row.scenario, row.filter, row.parameters};
    const auto [place, fresh] = index.try_emplace({subject, row.metric}, groups.size());
    if (fresh) groups.push_back({subject, row.metric, {}});
    groups[place->second].rows.push_back(row);
  }
  return groups;
}

std::string filters_in(std::span<const Row> rows) {
  std::string text;
  std::set<std::string> seen;
  for (const Row& row : rows) {
    const std::string name = row.filter + (row.parameters.empty() ? "" : ":" + row.parameters);
    if (seen.insert(name).second) text += (text.empty() ? "" : ", ") + name;
  }
  return text.empty() ? "nothing" : text;
}

/// Parameters that a filter appears with.
std::set<std::string> parameters_in(std::span<const Group> groups, const Subject& like) {
  std::set<std::string> parameters;
  for (const Group& g : groups) {
    if (g.subject.scenario == like.scenario && g.subject.filter == like.filter) parameters.insert(g.subject.parameters);
  }
  return parameters;
}

}  // namespace

Results load_results(const std::filesystem::path& directory) {
  if (!std::filesystem::exists(directory / "runs.csv")) {
    throw InputError(directory.string() + ": expected a folder of results with runs.csv (noctule-experiment run)");
  }
  return {config::load<Experiment>(directory / "experiment.yaml"), read_rows(directory / "runs.csv"),
          read_summary(directory / "summary.csv"), read_summary(directory / "timing.csv"),
          read_series(directory / "series.csv")};
}

std::vector<std::pair<std::string, std::string>> assignments(const std::string& parameters) {
  std::vector<std::pair<std::string, std::string>> result;
  for (const std::string& part : split(parameters, ';')) {
    const std::size_t equals = part.find('=');
    if (equals != std::string::npos) result.emplace_back(part.substr(0, equals), part.substr(equals + 1));
  }
  return result;
}

std::vector<Comparison> compare(std::span<const Row> a, const Selection& of_a, std::span<const Row> b,
                                const Selection& of_b) {
  const std::string name_a = of_a.filter.empty() ? of_b.filter : of_a.filter;
  const std::string name_b = of_b.filter.empty() ? of_a.filter : of_b.filter;
  const std::vector<Group> left = group(a, {name_a, of_a.parameters}), right = group(b, {name_b, of_b.parameters});
  if (left.empty()) throw InputError("compare: no run of '" + name_a + "' on the left; there are: " + filters_in(a));
  if (right.empty()) throw InputError("compare: no run of '" + name_b + "' on the right; there are: " + filters_in(b));
  std::vector<Comparison> comparisons;
  for (const Group& l : left) {
    for (const Group& r : right) {
      const bool same_place = l.subject.scenario == r.subject.scenario && l.metric == r.metric &&
                              (!name_a.empty() || l.subject.filter == r.subject.filter);
      const bool only_ones = parameters_in(left, l.subject).size() == 1 && parameters_in(right, r.subject).size() == 1;
      if (same_place && (l.subject.parameters == r.subject.parameters || only_ones)) {
        comparisons.push_back(compare(l.rows, r.rows));
      }
    }
  }
  if (comparisons.empty()) {
    throw InputError("compare: no scenario, metric and parameters in common; left: " + filters_in(a) +
                     "; right: " + filters_in(b));
  }
  correct(comparisons);
  return comparisons;
}

namespace {

/// How many parameters `r` has, when all of them are among those of `s`; else 0.
std::size_t shared_parameters(const Subject& s, const Subject& r) {
  const auto of_s = assignments(s.parameters), of_r = assignments(r.parameters);
  const bool all = std::ranges::all_of(of_r, [&](const auto& p) { return std::ranges::find(of_s, p) != of_s.end(); });
  return all ? of_r.size() : 0;
}

/// What is left of `parameters` without that key; nothing when it is not among them.
std::optional<std::string> without(const std::string& parameters, const std::string& key) {
  std::string rest;
  bool found = false;
  for (const auto& [name, value] : assignments(parameters)) {
    if (name == key) {
      found = true;
    } else {
      rest += name + "=" + value + ";";
    }
  }
  return found ? std::optional(rest) : std::nullopt;
}

/// Filters that differ from an earlier one in the value of `key` alone, against the first such.
template <class Groups>
std::vector<Comparison> comparisons_of_values(const Groups& candidates, const std::string& key) {
  std::vector<Comparison> family;
  for (const auto* g : candidates) {
    const auto rest = without(g->subject.parameters, key);
    if (!rest) continue;
    const auto first = std::ranges::find_if(candidates, [&](const auto* r) {
      return r->subject.filter == g->subject.filter && r->metric == g->metric &&
             without(r->subject.parameters, key) == rest;
    });
    if (*first != g) family.push_back(compare(g->rows, (*first)->rows));
  }
  return family;
}

}  // namespace

std::vector<Comparison> standard_comparisons(const Results& results) {
  const std::vector<Group> groups = group(results.runs, {});
  std::vector<Comparison> all;
  for (const ScenarioSpec& scenario : results.experiment.scenarios) {
    std::vector<const Group*> candidates;
    for (const Group& g : groups) {
      const bool compared = role_of(results.experiment, g.subject.filter) == Role::compared;
      if (g.subject.scenario == scenario.name && compared) candidates.push_back(&g);
    }
    if (candidates.empty()) continue;
    const std::string reference = candidates.front()->subject.filter;
    const bool several =
        std::ranges::any_of(candidates, [&](const Group* g) { return g->subject.filter != reference; });
    std::vector<Comparison> family;
    for (const Group* g : candidates) {
      if (several && g->subject.filter == reference) continue;
      // The reference's first, or better the one whose parameters are all among those of this filter.
      const Group* against = nullptr;
      std::size_t most_shared = 0;
      for (const Group* r : candidates) {
        if (r->subject.filter != reference || r->metric != g->metric) continue;
        const std::size_t shared = several ? shared_parameters(g->subject, r->subject) : 0;
        if (against == nullptr || shared > most_shared) against = r, most_shared = shared;
      }
      if (against != nullptr && against != g) family.push_back(compare(g->rows, against->rows));
    }
    correct(family);
    all.insert(all.end(), family.begin(), family.end());
    for (const std::string& key : results.experiment.compare) {
      std::vector<Comparison> values = comparisons_of_values(candidates, key);
      correct(values);
      all.insert(all.end(), values.begin(), values.end());
    }
  }
  return all;
}

Role role_of(const Experiment& experiment, const std::string& filter) {
  for (const FilterSpec& spec : experiment.filters) {
    if (spec.name == filter) return spec.role;
  }
  throw std::out_of_range("no filter '" + filter + "' in the experiment");
}

}  // namespace noctule::experiment
