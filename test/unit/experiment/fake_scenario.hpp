#pragma once
/// A scenario whose figures are known in advance.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <thread>

#include "config/config.hpp"
#include "core/error.hpp"
#include "core/rng.hpp"
#include "experiment/plan.hpp"

namespace noctule::experiment {

struct FakeParameters {
  double offset = 0.0;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("offset_m", &FakeParameters::offset, unit::metre, "added to every error");
  }
};

struct FakeFilterParameters {
  int particles = 1;
  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("particles", &FakeFilterParameters::particles, unit::one, "particles", at_least(1));
  }
};

/// Kind `fake` takes the filters `good` and `bad`, kind `other` takes `strange`. Error of a filter: the same normal
/// number for all filters of a seed, plus 1 / particles, plus the scenario's offset; `bad` is a metre worse, cannot
/// measure its error on every fifth seed and diverges on every third.
class FakeScenario : public Scenario {
 public:
  explicit FakeScenario(const ScenarioSpec& spec)
      : kind_(spec.kind), offset_(config::load<FakeParameters>(spec.config).offset) {}

  [[nodiscard]] std::vector<std::string> filters() const override {
    return kind_ == "fake" ? std::vector<std::string>{"good", "bad"} : std::vector<std::string>{"strange"};
  }
  [[nodiscard]] std::vector<std::string> metrics() const override { return {"error", "steps", "error_over_time"}; }
  void check(const FilterSpec& filter) const override {
    static_cast<void>(config::load<FakeFilterParameters>(effective_config(filter)));
  }
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec> filters) const override {
    ++runs;
    if (seed == refused_seed) throw InputError("no such world");
    if (slow) std::this_thread::sleep_for(std::chrono::microseconds(splitmix64(seed) % 3000));
    std::vector<FilterRun> results;
    const double common = Rng(seed, stream_id("fake")).normal();
    for (const FilterSpec& filter : filters) {
      const auto parameters = config::load<FakeFilterParameters>(effective_config(filter));
      const bool bad = filter.name == "bad";
      double error = common + 1.0 / parameters.particles + offset_ + (bad ? 1.0 : 0.0);
      if (bad && seed % 5 == 0) error = std::numeric_limits<double>::quiet_NaN();
      results.push_back({.figures = {{"error", error, "m"}, {"steps", 2.0, "1"}},
                         .timings = {{"cpu_per_step", 1e-3 * parameters.particles, "s"}},
                         .series = {{"error_over_time", "m", {0.0, 0.5}, {0.0, error}}},
                         .diverged = bad && seed % 3 == 0});
    }
    return results;
  }

  inline static std::atomic<int> runs{0};
  inline static std::uint64_t refused_seed = 0;
  inline static bool slow = false;

 private:
  std::string kind_;
  double offset_;
};

[[nodiscard]] inline std::unique_ptr<Scenario> make_fake(const ScenarioSpec& spec) {
  return std::make_unique<FakeScenario>(spec);
}

inline constexpr const char* kFakeExperiment = R"(
name: fake
first_seed: 1
last_seed: 12
scenarios:
  - {name: near, kind: fake}
  - {name: far, kind: fake, config: {offset_m: 10}}
filters:
  - {name: good, parameters: {N: [1, 4]}}
  - {name: bad}
)";

[[nodiscard]] inline Experiment parse_fake(const std::vector<std::string>& assignments = {},
                                           const std::string& text = kFakeExperiment) {
  return config::parse<Experiment>(text, "fake.yaml", assignments);
}

[[nodiscard]] inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A new empty folder that is gone after the test.
class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "noctule_experiment_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// What the body throws as InputError; empty when it throws none.
template <class Body>
[[nodiscard]] std::string refusal(const Body& body) {
  try {
    body();
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

}  // namespace noctule::experiment
