/// What is wrong with an experiment is said before its first run.
#include "experiment/plan.hpp"

#include <gtest/gtest.h>

#include "unit/experiment/fake_scenario.hpp"

namespace noctule::experiment {
namespace {

std::vector<std::string> names_of(std::span<const FilterSpec> filters) {
  std::vector<std::string> names;
  for (const FilterSpec& f : filters) names.push_back(f.name + "(" + f.parameters + ")");
  return names;
}

std::vector<FilterSpec> filters_of(const std::string& filters) {
  return parse_fake({"filters=" + filters}).filters;
}

TEST(Expand, MakesOneFilterOfEveryCombination) {
  EXPECT_EQ(
      names_of(expand(filters_of("[{name: pf, parameters: {N: [20, 100], mode: [a, b], gate: 3.5}}, {name: oracle}]"))),
      (std::vector<std::string>{"pf(N=20;mode=a;gate=3.5)", "pf(N=20;mode=b;gate=3.5)", "pf(N=100;mode=a;gate=3.5)",
                                "pf(N=100;mode=b;gate=3.5)", "oracle()"}));
}

TEST(Expand, RefusesWhatCannotStandInATable) {
  EXPECT_NE(refusal([] {
              static_cast<void>(expand(filters_of("[{name: pf, parameters: {N: []}}]")));
            }).find("filter 'pf': parameters: N: expected at least one value"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              static_cast<void>(expand(filters_of("[{name: pf, parameters: {N: \"1;2\"}}]")));
            }).find("N: expected plain values, got \"1;2\""),
            std::string::npos);
  EXPECT_NE(refusal([] {
              static_cast<void>(expand(filters_of("[{name: pf, parameters: N=5}]")));
            }).find("expected a map, got N=5"),
            std::string::npos);
  EXPECT_NE(refusal([] { static_cast<void>(expand(filters_of("[{name: pf}, {name: pf}]"))); }).find("named twice"),
            std::string::npos);
  EXPECT_NE(refusal([] { static_cast<void>(parse_fake({"filters=[{name: \"a,b\"}]"})); }).find("a name of letters"),
            std::string::npos);
}

TEST(EffectiveConfig, LaysParametersOverTheConfiguration) {
  const std::vector<FilterSpec> filters = expand(
      filters_of("[{name: pf, config: {particles: 7}, parameters: {N: [20]}}, {name: pf, config: {particles: 7}}]"));
  EXPECT_EQ(config::load<FakeFilterParameters>(effective_config(filters[0])).particles, 20);
  EXPECT_EQ(config::load<FakeFilterParameters>(effective_config(filters[1])).particles, 7);
}

TEST(Plan, GivesEachScenarioTheFiltersThatItTakes) {
  const Plan plan = make_plan(parse_fake({"scenarios=[{name: a, kind: fake}, {name: b, kind: other}]",
                                          "filters=[{name: good}, {name: strange}, {name: bad}]", "last_seed=3"}),
                              make_fake);
  ASSERT_EQ(plan.scenarios.size(), 2u);
  EXPECT_EQ(names_of(plan.scenarios[0].filters), (std::vector<std::string>{"good()", "bad()"}));
  EXPECT_EQ(names_of(plan.scenarios[1].filters), (std::vector<std::string>{"strange()"}));
  EXPECT_EQ(plan.pieces.size(), 6u);
  EXPECT_EQ(plan.runs(), 9u);
}

TEST(Plan, KeepsTheMetricsAskedFor) {
  EXPECT_EQ(make_plan(parse_fake(), make_fake).scenarios[0].metrics,
            (std::vector<std::string>{"error", "steps", "error_over_time"}));
  const Plan plan = make_plan(parse_fake({"metrics=[steps]"}), make_fake);
  EXPECT_EQ(plan.scenarios[0].metrics, std::vector<std::string>{"steps"});
  EXPECT_EQ(plan.scenarios[0].dropped, (std::vector<std::string>{"error", "error_over_time"}));
}

TEST(Plan, NamesTheKnownWhenAFilterOrMetricIsUnknown) {
  const auto plan_with = [](const std::vector<std::string>& assignments) {
    return refusal([&] { static_cast<void>(make_plan(parse_fake(assignments), make_fake)); });
  };
  EXPECT_EQ(plan_with({"filters=[{name: good}, {name: god}]"}),
            "filters: no scenario can take 'god'; near knows: good, bad; far knows: good, bad");
  EXPECT_EQ(plan_with({"metrics=[error, eror]"}),
            "metrics: no scenario measures 'eror'; near knows: error, steps, error_over_time; "
            "far knows: error, steps, error_over_time");
  EXPECT_EQ(plan_with({"metrics=[error]", "plots=[steps]"}), "plots: no scenario keeps the metric 'steps'");
  EXPECT_EQ(plan_with({"scenarios=[{name: a, kind: fake}, {name: b, kind: other}]"}),
            "scenario 'b': no filter of the list can run there; it knows: strange");
  EXPECT_NE(plan_with({"filters=[{name: good, parameters: {N: 0}}]"})
                .find("filter 'good': parameters: particles=0: particles: expected an integer >= 1, got 0"),
            std::string::npos);
  EXPECT_NE(plan_with({"scenarios[1].config.ofset_m=1"}).find("ofset_m"), std::string::npos);
}

TEST(Plan, NamesTheKnownKinds) {
  const std::string text = refusal([] { static_cast<void>(make_plan(parse_fake())); });
  EXPECT_NE(text.find("scenario 'near': kind: expected"), std::string::npos) << text;
  EXPECT_NE(text.find("contour_room"), std::string::npos) << text;
}

TEST(Experiment, IsReadBackFromWhatItWrites) {
  const Experiment experiment = parse_fake({"metrics=[error]", "filters[1].role=baseline"});
  const std::string text = config::dump(experiment);
  const Experiment again = config::parse<Experiment>(text);
  EXPECT_EQ(config::dump(again), text);
  EXPECT_EQ(names_of(expand(again.filters)), names_of(expand(experiment.filters)));
  EXPECT_EQ(again.filters[1].role, Role::baseline);
  EXPECT_EQ(config::load<FakeParameters>(again.scenarios[1].config).offset, 10.0);
}

TEST(Diverged, BeyondThreeMetresOrTenPercentOfThePath) {
  EXPECT_FALSE(has_diverged(3.0, 10.0));
  EXPECT_TRUE(has_diverged(3.001, 10.0));
  EXPECT_FALSE(has_diverged(9.9, 100.0));
  EXPECT_TRUE(has_diverged(10.1, 100.0));
  EXPECT_TRUE(has_diverged(std::numeric_limits<double>::quiet_NaN(), 100.0));
  EXPECT_TRUE(has_diverged(std::numeric_limits<double>::infinity(), 100.0));
}

}  // namespace
}  // namespace noctule::experiment
