#include "particle/alias_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/chi2.hpp"
#include "core/limits.hpp"

namespace noctule::particle {
namespace {

TEST(AliasTable, DrawsAsOftenAsTheWeightsSay) {
  const std::vector<double> weights{0.0, 1.0, 2.5, 1e-3, 40.0, 7.0, 0.0, 7.0, 3.0};
  AliasTable table;
  table.assign(weights);
  double total = 0.0;
  for (const double w : weights) total += w;
  constexpr int kTableDraws = 200000;
  std::vector<int> counts(weights.size());
  Rng rng(1, stream_id("alias_table_test"));
  for (int i = 0; i < kTableDraws; ++i) ++counts[table.draw(rng)];
  double chi2 = 0.0;
  int dof = -1;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_DOUBLE_EQ(table.probability(i), weights[i] / total);
    if (weights[i] == 0.0) {
      EXPECT_EQ(counts[i], 0);
      continue;
    }
    const double expected = kTableDraws * weights[i] / total;
    chi2 += (counts[i] - expected) * (counts[i] - expected) / expected;
    ++dof;
  }
  EXPECT_LT(chi2, chi2_quantile(0.999, dof));
}

TEST(AliasTable, OneWeightAndEqualWeights) {
  AliasTable table;
  Rng rng(1);
  table.assign(std::vector{3.0});
  EXPECT_EQ(table.draw(rng), 0u);
  table.assign(std::vector<double>(1000, 0.1));
  for (int i = 0; i < 1000; ++i) EXPECT_LT(table.draw(rng), 1000u);
}

TEST(AliasTable, RefusesWhatIsNoDistribution) {
  AliasTable table;
  EXPECT_THROW(table.assign({}), std::invalid_argument);
  EXPECT_THROW(table.assign(std::vector{0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(table.assign(std::vector{1.0, -1.0}), std::invalid_argument);
  EXPECT_THROW(table.assign(std::vector{1.0, kInf}), std::invalid_argument);
  EXPECT_THROW(table.assign(std::vector{1.0, kNan}), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::particle
