/// The growth model: known errors of a bootstrap filter, the exact posterior below all of them, gains that paired runs
/// show, and errors in configurations.
#include "experiment/growth_model.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "core/error.hpp"
#include "eval/statistics.hpp"

namespace noctule::experiment {
namespace {

GrowthModelRuns scenario(double process_variance) {
  ScenarioSpec spec{"growth", "growth_model", {}};
  spec.config =
      config::override_tree({}, std::vector<std::string>{"process_variance=" + std::to_string(process_variance)});
  return GrowthModelRuns(spec);
}

/// state_rmse of each filter at every seed.
std::vector<std::vector<double>> errors(double process_variance, const std::vector<FilterSpec>& filters, int seeds) {
  const GrowthModelRuns growth = scenario(process_variance);
  std::vector<std::vector<double>> result(filters.size());
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto runs = growth.run(static_cast<std::uint64_t>(seed), filters);
    for (std::size_t i = 0; i < runs.size(); ++i) result[i].push_back(runs[i].figures.at(0).value);
  }
  return result;
}

FilterSpec filter(const std::string& name, const std::string& parameters = {}) {
  return {.name = name, .config = {}, .sweep = {}, .parameters = parameters};
}

/// Means of 20 000 runs of an independent implementation, and the bands that the project holds itself to.
TEST(GrowthModel, MatchedParticleFilterHasItsKnownError) {
  const std::vector<FilterSpec> filters{filter("pf", "N=20"), filter("pf", "N=100")};
  const auto q10 = errors(10.0, filters, 1000), q5 = errors(5.0, filters, 1000);
  EXPECT_NEAR(eval::mean(q10[0]), 6.39, 0.15);
  EXPECT_NEAR(eval::mean(q10[1]), 4.85, 0.10);
  EXPECT_NEAR(eval::mean(q5[0]), 5.50, 0.15);
  EXPECT_NEAR(eval::mean(q5[1]), 4.16, 0.10);
}

TEST(GrowthModel, NeighboursAndMovesHelpAtTwentyParticles) {
  const auto e = errors(10.0, {filter("pf", "N=20"), filter("apf", "N=20"), filter("apf_resample_move", "N=20")}, 600);
  for (const auto& [better, percent] : {std::pair(1, 5.0), std::pair(2, 8.0)}) {
    const eval::PairedDifference d = eval::paired_difference(e[static_cast<std::size_t>(better)], e[0]);
    EXPECT_LT(d.p_value, 0.001);
    EXPECT_LT(d.mean, -0.01 * percent * eval::mean(e[0]));
  }
}

TEST(GrowthModel, NothingIsBelowTheExactPosteriorAndManyParticlesReachIt) {
  const auto e = errors(10.0, {filter("oracle"), filter("pf", "N=5000"), filter("dead_reckoning")}, 60);
  const eval::PairedDifference d = eval::paired_difference(e[1], e[0]);
  EXPECT_NEAR(d.mean, 0.0, 0.05);
  EXPECT_GT(eval::mean(e[2]), 1.5 * eval::mean(e[0]));
}

TEST(GrowthModel, EveryFilterSaysAllItsFigures) {
  const GrowthModelRuns growth = scenario(10.0);
  for (const std::string& name : growth.filters()) {
    const auto runs = growth.run(3, std::vector{filter(name)}), again = growth.run(3, std::vector{filter(name)});
    EXPECT_FALSE(runs[0].diverged);
    EXPECT_EQ(runs[0].series.at(0).values.size(), 50u);
    ASSERT_EQ(runs[0].figures.size(), name == "oracle" || name == "dead_reckoning" ? 1u : 3u);
    for (std::size_t i = 0; i < runs[0].figures.size(); ++i) {
      EXPECT_EQ(runs[0].figures[i].value, again[0].figures[i].value);
    }
  }
}

TEST(GrowthModel, ApfKeepsMoreDistinctParticles) {
  const GrowthModelRuns growth = scenario(10.0);
  const auto runs = growth.run(5, std::vector{filter("pf"), filter("apf")});
  EXPECT_GT(runs[1].figures.at(1).value, 1.2 * runs[0].figures.at(1).value);
}

TEST(GrowthModel, KeysOfOtherFiltersAreRefusedByName) {
  const GrowthModelRuns growth = scenario(10.0);
  const auto text_of = [&](const FilterSpec& spec) {
    try {
      growth.check(spec);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(text_of(filter("pf", "N=20;filter_q=1")), "");
  EXPECT_EQ(text_of(filter("pso_pf", "swarm.variant=literature")), "");
  EXPECT_EQ(text_of(filter("pf", "apf.split=lower_half")),
            "filter 'pf': apf: belongs to apf and apf_resample_move only");
  EXPECT_NE(text_of(filter("apf", "swarm.iterations=2")).find("belongs to pso_pf and bat_pf"), std::string::npos);
  EXPECT_NE(text_of(filter("pf", "filter_q=2")).find("matched"), std::string::npos);
  EXPECT_NE(text_of(filter("pf", "echo=2")).find("echo"), std::string::npos);
}

}  // namespace
}  // namespace noctule::experiment
