#pragma once
/// The univariate growth model of paper 002 (eqs. 10, 11; tables 1, 2): filters of a scalar state.
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.hpp"
#include "particle/state_filter.hpp"

namespace noctule::experiment {

struct GrowthModelParameters {
  int steps = 50;  ///< the paper does not say
  double process_variance = 10.0;
  double measurement_variance = 1.0;
  double initial_variance = 1.0;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = GrowthModelParameters;
    v.field("steps", &P::steps, unit::one, "measurements of a run", between(1, 1'000'000));
    v.field("process_variance", &P::process_variance, unit::one, "Q of the truth", positive());
    v.field("measurement_variance", &P::measurement_variance, unit::one, "R of the truth and of the filters",
            positive());
    v.field("initial_variance", &P::initial_variance, unit::one, "of the state before the first step", positive());
  }
};

/// Process variance that a filter believes in.
enum class FilterQ : std::int8_t {
  matched,  ///< that of the truth
  one       ///< 1, whatever the truth: with it table 1 of the paper comes out
};

struct GrowthFilterParameters {
  int particles = 100;
  FilterQ filter_q = FilterQ::matched;
  particle::Resampling resampling = particle::Resampling::systematic;
  std::optional<particle::SwarmParameters> swarm;         ///< of pso_pf and bat_pf
  std::optional<particle::ApfParameters> apf;             ///< of apf and apf_resample_move
  std::optional<particle::ResampleMoveParameters> moves;  ///< of resample_move and apf_resample_move

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = GrowthFilterParameters;
    v.field("particles", &P::particles, unit::one, "number of particles", between(1, 10'000'000));
    v.choice("filter_q", &P::filter_q, {{"matched", FilterQ::matched}, {"1", FilterQ::one}, {"1.0", FilterQ::one}},
             "process variance of the filter: that of the truth, or 1");
    v.choice("resampling", &P::resampling, particle::resampling_choices(), "how particles are redrawn");
    v.group("swarm", &P::swarm, "of pso_pf and bat_pf");
    v.group("apf", &P::apf, "of apf and apf_resample_move");
    v.group("moves", &P::moves, "of resample_move and apf_resample_move");
  }
};

/// Filters: `pf`, `pso_pf`, `bat_pf`, `apf`, `resample_move`, `apf_resample_move`, `oracle` (the exact posterior on a
/// grid, the limit) and `dead_reckoning` (the exact prediction without measurements). Estimates are means.
class GrowthModelRuns : public Scenario {
 public:
  explicit GrowthModelRuns(const ScenarioSpec&);
  [[nodiscard]] std::vector<std::string> filters() const override;
  [[nodiscard]] std::vector<std::string> metrics() const override;
  void check(const FilterSpec&) const override;
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec>) const override;

 private:
  GrowthModelParameters parameters_;
};

}  // namespace noctule::experiment
