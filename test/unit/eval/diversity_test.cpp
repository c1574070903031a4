#include "eval/diversity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/rng.hpp"

namespace noctule::eval {
namespace {

using Parents = std::vector<std::vector<std::uint32_t>>;

TEST(Diversity, ByHand) {
  const Parents parents{{0, 1, 2, 3}, {0, 0, 2, 2}, {1, 1, 1, 3}, {0, 1, 2, 3}};
  const auto d = diversity(parents, 4, 2);
  ASSERT_EQ(d.size(), 4u);
  EXPECT_EQ(d[0].distinct_parents, 4);
  EXPECT_EQ(d[1].distinct_parents, 2);
  EXPECT_EQ(d[1].distinct_founders, 2);  // 0 and 2
  EXPECT_EQ(d[2].distinct_parents, 2);   // 1 and 3 of the step before, children of 0 and 2
  EXPECT_EQ(d[2].distinct_ancestors, 2);
  EXPECT_EQ(d[2].distinct_founders, 2);
  EXPECT_EQ(d[3].distinct_parents, 4);
  EXPECT_EQ(d[3].distinct_ancestors, 2);
}

TEST(Diversity, FoundersNeverRiseAndALongLagMeansFounders) {
  Rng rng(3);
  Parents parents;
  for (int step = 0; step < 60; ++step) {
    parents.emplace_back(50);
    for (auto& p : parents.back()) p = static_cast<std::uint32_t>(rng.index(50));
  }
  const auto d = diversity(parents, 50, 1000), one = diversity(parents, 50, 1);
  int last = 50;
  for (std::size_t step = 0; step < d.size(); ++step) {
    EXPECT_LE(d[step].distinct_founders, last);
    last = d[step].distinct_founders;
    EXPECT_EQ(d[step].distinct_ancestors, d[step].distinct_founders);
    EXPECT_EQ(one[step].distinct_ancestors, one[step].distinct_parents);
  }
  EXPECT_LT(last, 8);  // multinomial resampling: about 2 N / t lineages are left
}

TEST(Diversity, TheNumberOfParticlesMayChange) {
  const auto d = diversity(Parents{{0, 1, 1, 0, 1}, {4, 3}}, 2, 1);
  EXPECT_EQ(d[0].distinct_parents, 2);
  EXPECT_EQ(d[1].distinct_parents, 2);
  EXPECT_EQ(d[1].distinct_founders, 2);
}

TEST(Diversity, Refusals) {
  EXPECT_THROW((void)diversity(Parents{{0}}, 1, 0), std::invalid_argument);
  EXPECT_THROW((void)diversity(Parents{{1}}, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)diversity(Parents{{0}, {1}}, 3, 1), std::invalid_argument);
}

TEST(DistinctPoses, UpToTheResolution) {
  const std::vector<WeightedPose> particles{
      {{1, 2, 3}, 0.2}, {{1, 2, 3}, 0.3}, {{1, 2, 3 + 1e-11}, 0.3}, {{1, 2, 3 + 1e-6}, 0.1}, {{1, 2.5, 3}, 0.1}};
  EXPECT_EQ(distinct_poses(particles), 3);
  EXPECT_EQ(distinct_poses(particles, 1e-3), 2);
  EXPECT_EQ(distinct_poses({}), 0);
}

TEST(EffectiveSampleSize, ClosedForms) {
  EXPECT_NEAR(effective_sample_size(std::vector<WeightedPose>{{{}, 2.0}, {{}, 2.0}, {{}, 2.0}}), 3.0, 1e-12);
  EXPECT_NEAR(effective_sample_size(std::vector<WeightedPose>{{{}, 1.0}, {{}, 0.0}}), 1.0, 1e-12);
  EXPECT_NEAR(effective_sample_size(std::vector<WeightedPose>{{{}, 0.75}, {{}, 0.25}}), 1.6, 1e-12);
  EXPECT_TRUE(std::isnan(effective_sample_size(std::vector<WeightedPose>{{{}, 0.0}})));
}

}  // namespace
}  // namespace noctule::eval
