#pragma once
/// An experiment: filters over scenarios and seeds on the same random numbers.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/parameters.hpp"
#include "experiment/row.hpp"

namespace noctule::experiment {

/// A filter and what differs from its configuration file.
struct FilterSpec {
  std::string name;              ///< by which results are quoted: `pf`, `dead_reckoning`, ...
  std::filesystem::path config;  ///< parameters of the filter; empty: none or defaults
  std::string parameters;        ///< `key=value;key=value` on top of them

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &FilterSpec::name, unit::one, "name of the filter");
    v.field("config", &FilterSpec::config, unit::one, "its configuration file");
    v.field("parameters", &FilterSpec::parameters, unit::one, "key=value;key=value on top of it");
  }
};

/// A scenario and the files that it is made of.
struct ScenarioSpec {
  std::string name;
  std::string kind;  ///< which class of scenario reads the rest
  std::filesystem::path world;
  std::filesystem::path robot;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &ScenarioSpec::name, unit::one, "name by which results are quoted");
    v.field("kind", &ScenarioSpec::kind, unit::one, "contour_room");
    v.field("world", &ScenarioSpec::world, unit::one, "world file");
    v.field("robot", &ScenarioSpec::robot, unit::one, "robot file");
  }
};

/// A published figure to stand beside ours.
struct Reference {
  std::string source;  ///< whose: "paper 002 table 3, PF"
  std::string scenario;
  std::string metric;
  double value = 0.0;  ///< SI
  std::string unit;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("source", &Reference::source, unit::one, "paper, table and column");
    v.field("scenario", &Reference::scenario, unit::one, "scenario it belongs to");
    v.field("metric", &Reference::metric, unit::one, "metric it is a value of");
    v.field("value", &Reference::value, unit::one, "the printed value, in SI", any_finite());
    v.field("unit", &Reference::unit, unit::one, "unit of the value");
  }
};

struct Experiment {
  std::string name;
  std::uint64_t first_seed = 1;
  std::uint64_t last_seed = 1;
  std::vector<ScenarioSpec> scenarios;
  std::vector<FilterSpec> filters;
  std::vector<Reference> references;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("name", &Experiment::name, unit::one, "title of the results");
    v.field("first_seed", &Experiment::first_seed, unit::one, "first seed");
    v.field("last_seed", &Experiment::last_seed, unit::one, "last seed");
    v.list("scenarios", &Experiment::scenarios, "where the filters run");
    v.list("filters", &Experiment::filters, "what is compared");
    v.list("references", &Experiment::references, "published figures to stand beside ours");
  }
  [[nodiscard]] std::string validate() const;
};

/// Makes one world, path, odometry and measurement stream per seed and feeds it to every filter.
class Scenario {
 public:
  virtual ~Scenario() = default;
  /// \throws InputError naming the known filters when this scenario cannot take one of them
  virtual void check(std::span<const FilterSpec> filters) const = 0;
  /// Thread-safe; depends on nothing but the arguments.
  [[nodiscard]] virtual RunRows run(std::uint64_t seed, std::span<const FilterSpec> filters) const = 0;
};

/// \throws InputError naming the known kinds, or what is wrong in the files
[[nodiscard]] std::unique_ptr<Scenario> make_scenario(const ScenarioSpec&);

/// `key=value;key=value` as assignments for config::load. \throws InputError
[[nodiscard]] std::vector<std::string> assignments(const FilterSpec&);

}  // namespace noctule::experiment
