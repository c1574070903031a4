#pragma once
/// An experiment: filters over scenarios and seeds on the same random numbers.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "config/tree.hpp"
#include "core/parameters.hpp"
#include "experiment/row.hpp"

namespace noctule::experiment {

/// What a filter is in a comparison: one of those compared, or a line to see them by.
enum class Role { compared, baseline, limit };

/// A filter and what differs from its configuration: in an experiment file a family of filters (a value of `parameters`
/// may be a list; every combination is one filter), after expand() a single one.
struct FilterSpec {
  std::string name;  ///< by which results are quoted: `pf`, `dead_reckoning`, ...
  Role role = Role::compared;
  config::Tree config;     ///< `{file: ../filters/pf.yaml}` or keys; nothing: defaults
  config::Tree sweep;      ///< `{N: [20, 50, 100], filter_q: matched}`
  std::string parameters;  ///< of a single filter: `N=20;filter_q=matched`; not in files

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &FilterSpec::name, "name of the filter");
    v.choice("role", &FilterSpec::role,
             {{"compared", Role::compared}, {"baseline", Role::baseline}, {"limit", Role::limit}},
             "compared with others, or drawn as the line to beat or the line that nothing can beat");
    v.field("config", &FilterSpec::config, "its configuration");
    v.field("parameters", &FilterSpec::sweep, "values on top of it; a list: one filter each");
  }
};

/// A scenario; `config` is read by the class of that kind.
struct ScenarioSpec {
  std::string name;
  std::string kind;
  config::Tree config;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &ScenarioSpec::name, "name by which results are quoted");
    v.field("kind", &ScenarioSpec::kind, "which class of scenario reads the configuration");
    v.field("config", &ScenarioSpec::config, "what that kind needs");
  }
};

/// A published figure to stand beside ours.
struct Reference {
  std::string source;      ///< whose: "paper 002 table 3"
  std::string filter;      ///< as the source calls it: "PF-SLAM"
  std::string parameters;  ///< `N=20`, where the source says so
  std::string scenario;
  std::string metric;
  double value = 0.0;  ///< SI
  std::string unit;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("source", &Reference::source, "paper and table");
    v.field("filter", &Reference::filter, "the filter, as the source calls it");
    v.field("parameters", &Reference::parameters, "key=value;key=value, where the source says so");
    v.field("scenario", &Reference::scenario, "scenario it belongs to");
    v.field("metric", &Reference::metric, "metric it is a value of");
    v.field("value", &Reference::value, unit::one, "the printed value, in SI", any_finite());
    v.field("unit", &Reference::unit, "unit of the value");
  }
};

struct Experiment {
  std::string name;
  std::uint64_t first_seed = 1;
  std::uint64_t last_seed = 1;
  std::vector<ScenarioSpec> scenarios;
  std::vector<FilterSpec> filters;
  std::vector<std::string> metrics;  ///< empty: all that the scenarios have
  std::vector<std::string> plots;    ///< metrics that get plots in the report; empty: all
  std::vector<std::string> compare;  ///< parameters whose values are compared too, all else being equal
  std::vector<Reference> references;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &Experiment::name, "title of the results");
    v.field("first_seed", &Experiment::first_seed, unit::one, "first seed");
    v.field("last_seed", &Experiment::last_seed, unit::one, "last seed");
    v.list("scenarios", &Experiment::scenarios, "where the filters run");
    v.list("filters", &Experiment::filters, "what is compared");
    v.field("metrics", &Experiment::metrics, "what is kept; empty: all");
    v.field("plots", &Experiment::plots, "metrics that get plots in the report; empty: all");
    v.field("compare", &Experiment::compare,
            "parameters: filters that differ in nothing else are compared with the first of them");
    v.list("references", &Experiment::references, "published figures to stand beside ours");
  }
  [[nodiscard]] std::string validate() const;
};

/// Makes one world, path, odometry and measurement stream per seed and feeds it to every filter. A kind reads its
/// configuration by `config::load<TheKindsParameters>(spec.config)`, a filter's by
/// `config::load<TheFiltersParameters>(effective_config(filter))`.
class Scenario {
 public:
  virtual ~Scenario() = default;
  /// Names of the filters that it can take.
  [[nodiscard]] virtual std::vector<std::string> filters() const = 0;
  /// Names of all figures and series that its runs can have; timings are not among them.
  [[nodiscard]] virtual std::vector<std::string> metrics() const = 0;
  /// \param filter one of filters() \throws InputError when its configuration makes no sense
  virtual void check(const FilterSpec& filter) const = 0;
  /// One result per filter. Thread-safe; depends on nothing but the arguments. \param filters each one of filters()
  [[nodiscard]] virtual std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec> filters) const = 0;
};

/// \throws InputError naming the known kinds, or what is wrong in the configuration
[[nodiscard]] std::unique_ptr<Scenario> make_scenario(const ScenarioSpec&);

/// Every combination of the values of `parameters` as a filter of its own, the last key varying fastest.
/// \throws InputError naming the place
[[nodiscard]] std::vector<FilterSpec> expand(std::span<const FilterSpec>);

/// The configuration of a single filter with its parameters in place (`N` stands for `particles`).
/// \throws InputError
[[nodiscard]] config::Tree effective_config(const FilterSpec&);

/// The position error at the end is not a number, or exceeds 3 m or 10 % of the path, whichever is larger.
[[nodiscard]] bool has_diverged(double final_position_error, double path_length);

/// CPU time of the calling thread [s].
[[nodiscard]] double cpu_seconds();

/// Most memory that the process has held since the latest reset_peak_memory() [B], of all threads together; NaN where
/// the system does not tell.
[[nodiscard]] double peak_memory();
void reset_peak_memory();

}  // namespace noctule::experiment
