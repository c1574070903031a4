#include "particle/genealogy.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <stdexcept>

#include "core/rng.hpp"
#include "particle/parallel.hpp"
#include "particle/resampling.hpp"

namespace noctule::particle {
namespace {

TEST(Genealogy, EqualsDeepCopiesOverARandomHistory) {
  constexpr std::size_t n = 20;
  Genealogy<int> tree(n);
  std::vector<std::vector<int>> copies(n);
  std::vector<std::uint32_t> founders(n);
  for (std::size_t i = 0; i < n; ++i) founders[i] = static_cast<std::uint32_t>(i);
  Rng rng(4);
  std::vector<double> w(n);
  std::vector<std::uint32_t> counts(n), ancestors(n);
  int entry = 0;
  for (int step = 0; step < 200; ++step) {
    for (std::size_t i = 0; i < n; ++i) {
      tree.append(i, entry);
      copies[i].push_back(entry++);
    }
    if (step % 3 != 0) continue;
    for (double& v : w) v = rng.uniform();
    make_resampler(Resampling::systematic)->offspring(w, n, rng, counts);
    place_in_slots(counts, ancestors);
    tree.resample(ancestors);
    const auto old_copies = copies;
    const auto old_founders = founders;
    for (std::size_t i = 0; i < n; ++i) {
      copies[i] = old_copies[ancestors[i]];
      founders[i] = old_founders[ancestors[i]];
    }
    EXPECT_EQ(tree.distinct_founders(), std::set<std::uint32_t>(founders.begin(), founders.end()).size());
  }
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(tree.history(i), copies[i]);
  std::set<int> alive;
  for (const auto& history : copies) alive.insert(history.begin(), history.end());
  EXPECT_EQ(tree.stored(), alive.size());  // dead branches are freed, shared ones are stored once
}

TEST(Genealogy, MayChangeTheNumberOfParticles) {
  Genealogy<int> tree(2);
  tree.append(0, 10);
  tree.append(1, 20);
  tree.resample(std::vector<std::uint32_t>{1, 1, 1});
  tree.append(2, 30);
  EXPECT_EQ(tree.history(0), (std::vector{20}));
  EXPECT_EQ(tree.history(2), (std::vector{20, 30}));
  EXPECT_EQ(tree.distinct_founders(), 1u);
  EXPECT_EQ(tree.stored(), 2u);
}

TEST(ForBlocks, VisitsEveryIndexOnceAndRethrows) {
  for (const int threads : {1, 2, 3}) {
    std::vector<std::atomic<int>> visits(101);
    for_blocks(visits.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    for (const auto& v : visits) EXPECT_EQ(v.load(), 1);
    EXPECT_THROW(for_blocks(50, threads, [](std::size_t, std::size_t) { throw std::runtime_error("body"); }),
                 std::runtime_error);
  }
}

}  // namespace
}  // namespace noctule::particle
