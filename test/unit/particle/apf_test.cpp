/// Neighbours, spreads and the neighbour optimisation, against brute force and by their invariants.
#include "particle/apf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "core/angles.hpp"
#include "particle/pose_apf.hpp"
#include "particle/resampling.hpp"

namespace noctule::particle {
namespace {

struct Cloud {
  std::vector<double> values, weights;
  std::vector<std::uint32_t> counts;
  int dimension = 1;
  std::uint32_t angles = 0;
  [[nodiscard]] States states() const { return {values.data(), weights.size(), dimension, angles}; }
};

/// A normal cloud whose weights prefer one side of it; offspring by SSP.
Cloud cloud(std::size_t n, int dimension, std::uint64_t seed, std::uint32_t angles = 0, double heading = 0.0) {
  Rng rng(seed);
  Cloud c{{}, std::vector<double>(n), std::vector<std::uint32_t>(n), dimension, angles};
  for (std::size_t i = 0; i < n; ++i) {
    double squared = 0.0;
    for (int k = 0; k < dimension; ++k) {
      const double e = rng.normal();
      squared += (e - 0.7) * (e - 0.7);
      const bool angle = ((angles >> k) & 1u) != 0;
      c.values.push_back(angle ? wrap(heading + 0.3 * e) : 2.0 * e);
    }
    c.weights[i] = std::exp(-2.0 * squared);
  }
  make_resampler(Resampling::ssp)->offspring(c.weights, static_cast<std::uint32_t>(n), rng, c.counts);
  return c;
}

TEST(KdTree, AgreesWithLookingAtAllWhilePointsGo) {
  for (const std::size_t n : {1u, 40u, 160u, 161u, 900u}) {
    for (const int dimension : {1, 2, 3, 5}) {
      Rng rng(n);
      std::vector<double> points(n * static_cast<std::size_t>(dimension));
      for (double& v : points) v = rng.uniform() < 0.1 ? 0.5 : rng.normal();  // some on a common plane
      KdTree tree;
      tree.build(points, dimension);
      std::set<std::uint32_t> left;
      for (std::uint32_t i = 0; i < n; ++i) left.insert(i);
      std::vector<double> x(static_cast<std::size_t>(dimension));
      const auto squared = [&](std::uint32_t i) {
        double sum = 0.0;
        for (std::size_t k = 0; k < x.size(); ++k) sum += std::pow(points[i * x.size() + k] - x[k], 2);
        return sum;
      };
      std::vector<std::uint32_t> near;
      while (!left.empty()) {
        for (double& v : x) v = 1.5 * rng.normal();
        std::vector<double> distances;
        for (const std::uint32_t i : left) distances.push_back(squared(i));
        std::ranges::sort(distances);
        ASSERT_EQ(tree.size(), left.size());
        ASSERT_DOUBLE_EQ(squared(tree.farthest(x.data())), distances.back());
        tree.nearest(x.data(), 7, near);
        ASSERT_EQ(near.size(), std::min<std::size_t>(7, left.size()));
        for (std::size_t k = 0; k < near.size(); ++k) ASSERT_NEAR(squared(near[k]), distances[k], 1e-7 * distances[k]);
        for (int gone = 0; gone < 1 + static_cast<int>(n) / 40 && !left.empty(); ++gone) {
          const std::uint32_t point = *std::next(left.begin(), static_cast<std::ptrdiff_t>(rng.index(left.size())));
          tree.remove(point);
          left.erase(point);
        }
      }
      EXPECT_EQ(tree.size(), 0u);
    }
  }
}

TEST(Spread, WhitenedStatesHaveUnitCovarianceAlsoAcrossTheCutOfAnAngle) {
  for (const double heading : {0.0, kPi - 0.01}) {
    const Cloud c = cloud(400, 3, 2, 0b100, heading);
    const Spread spread(c.states(), c.weights);
    const double total = std::accumulate(c.weights.begin(), c.weights.end(), 0.0);
    double sums[3] = {}, squares[3][3] = {};
    for (std::size_t i = 0; i < c.weights.size(); ++i) {
      double y[3];
      spread.whiten(c.states()[i], y);
      for (int k = 0; k < 3; ++k) {
        sums[k] += c.weights[i] / total * y[k];
        for (int l = 0; l < 3; ++l) squares[k][l] += c.weights[i] / total * y[k] * y[l];
      }
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(sums[k], 0.0, 1e-9);
      for (int l = 0; l < 3; ++l) EXPECT_NEAR(squares[k][l], k == l ? 1.0 : 0.0, 1e-6);
    }
    EXPECT_LT(std::abs(wrap(spread.mean(2) - heading)), 0.5);
  }
}

TEST(Spread, AnglesAllAroundHaveTheirCircularMean) {
  const std::vector<double> angles{-3.0, -1.0, 0.2, 0.4, 0.6, 1.5, 3.1};
  const Spread spread({angles.data(), angles.size(), 1, 1});
  double cosine = 0.0, sine = 0.0;
  for (const double a : angles) cosine += std::cos(a), sine += std::sin(a);
  const double direction = std::atan2(sine, cosine);
  double offsets = 0.0;
  for (const double a : angles) offsets += wrap(a - direction) / static_cast<double>(angles.size());
  EXPECT_NEAR(spread.mean(0), wrap(direction + offsets), 1e-12);
  EXPECT_THROW(Spread({angles.data(), 0, 1, 0}), std::invalid_argument);
}

class ApfCloud : public testing::TestWithParam<std::tuple<int, int, ApfSplit>> {
 protected:
  [[nodiscard]] Cloud make(std::uint64_t seed) const {
    const int dimension = std::get<0>(GetParam());
    return cloud(static_cast<std::size_t>(std::get<1>(GetParam())), dimension, seed, dimension == 3 ? 0b100u : 0u, 3.0);
  }
  [[nodiscard]] Apf apf() const { return Apf({.split = std::get<2>(GetParam())}); }
};

TEST_P(ApfCloud, KeepsTheNumberAndEveryDistinctSurvivor) {
  Apf optimiser = apf();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Cloud c = make(seed);
    const std::vector<std::uint32_t> before = c.counts;
    std::vector<std::uint32_t> ancestors(before.size());
    Rng rng(seed);
    const auto moves = optimiser.optimise(c.states(), c.weights, c.counts, ancestors, rng);
    EXPECT_GT(moves.size(), 0u);
    std::vector<std::uint32_t> unmoved(before.size(), 0);
    for (const std::uint32_t a : ancestors) ++unmoved[a];
    EXPECT_EQ(unmoved, c.counts);
    std::set<std::uint32_t> slots;
    for (const MovedParticle& move : moves) {
      EXPECT_TRUE(slots.insert(move.slot).second);
      EXPECT_EQ(ancestors[move.slot], move.from);
      EXPECT_GT(before[move.toward], 0u);
      EXPECT_GE(move.fraction, 0.0);
      EXPECT_LE(move.fraction, 1.0);
      --unmoved[move.from];
    }
    std::uint32_t most = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(unmoved[i] > 0, before[i] > 0) << i;  // survivors stay, nobody else comes in unmoved
      EXPECT_LE(unmoved[i], before[i]);
      most = std::max(most, unmoved[i]);
    }
    for (std::size_t i = 0; i < before.size(); ++i) {  // only the most numerous gave copies away
      EXPECT_TRUE(unmoved[i] == before[i] || unmoved[i] + 1 >= most) << i;
    }
  }
}

TEST_P(ApfCloud, MovesAlongTheSegmentToTheNeighbour) {
  Apf optimiser = apf();
  Cloud c = make(3);
  Rng rng(3);
  for (const MovedParticle& move : optimiser.find_moves(c.states(), c.weights, c.counts, rng)) {
    std::vector<double> state(static_cast<std::size_t>(c.dimension));
    apply_move(move, c.states(), state.data());
    for (int k = 0; k < c.dimension; ++k) {
      const double from = c.states()[move.from][k];
      double way = c.states()[move.toward][k] - from, gone = state[static_cast<std::size_t>(k)] - from;
      if (c.states().is_angle(k)) way = wrap(way), gone = wrap(gone);
      EXPECT_NEAR(gone, move.fraction * way, 1e-12);
    }
  }
}

TEST_P(ApfCloud, DoesNothingOnEqualWeights) {
  Apf optimiser = apf();
  Cloud c = make(4);
  std::ranges::fill(c.counts, 1u);
  std::ranges::fill(c.weights, 1.0);
  std::vector<std::uint32_t> ancestors(c.counts.size());
  Rng rng(4);
  EXPECT_TRUE(optimiser.optimise(c.states(), c.weights, c.counts, ancestors, rng).empty());
  for (std::uint32_t i = 0; i < ancestors.size(); ++i) EXPECT_EQ(ancestors[i], i);
}

INSTANTIATE_TEST_SUITE_P(Sizes, ApfCloud,
                         testing::Combine(testing::Values(1, 2, 3), testing::Values(60, 700),
                                          testing::Values(ApfSplit::discarded, ApfSplit::lower_half)));

/// Paper 002 taken literally, in coordinates that are white already.
TEST(Apf, ChoosesTheParticlesThatThePaperDescribes) {
  for (const int dimension : {1, 2}) {
    Cloud c = cloud(50, dimension, 6);
    const Spread spread(c.states());
    std::vector<std::vector<double>> y(c.weights.size(), std::vector<double>(static_cast<std::size_t>(dimension)));
    for (std::size_t i = 0; i < y.size(); ++i) spread.whiten(c.states()[i], y[i].data());
    const auto squared = [&](const std::vector<double>& a, const std::vector<double>& b) {
      double sum = 0.0;
      for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
      return sum;
    };
    std::vector<std::uint32_t> optimised, fixed;
    for (std::uint32_t i = 0; i < y.size(); ++i) (c.counts[i] > 0 ? fixed : optimised).push_back(i);
    std::vector<double> reference = y[*std::ranges::max_element(fixed, {}, [&](auto i) { return c.weights[i]; })];
    Apf apf;
    Rng rng(6);
    const auto moves = apf.find_moves(c.states(), c.weights, c.counts, rng);
    ASSERT_EQ(moves.size(), optimised.size() / static_cast<std::size_t>(2 * dimension + 1));
    for (const MovedParticle& move : moves) {
      const auto farthest = std::ranges::max_element(optimised, {}, [&](auto i) { return squared(y[i], reference); });
      ASSERT_EQ(move.from, *farthest);
      const auto nearer = [&](auto a, auto b) { return squared(y[a], y[move.from]) < squared(y[b], y[move.from]); };
      std::ranges::sort(fixed, nearer);
      const auto toward = *std::max_element(fixed.begin(), fixed.begin() + 2 * dimension,
                                            [&](auto a, auto b) { return c.weights[a] < c.weights[b]; });
      ASSERT_EQ(move.toward, toward);
      std::ranges::sort(optimised, nearer);
      optimised.erase(optimised.begin(), optimised.begin() + 2 * dimension + 1);
      std::vector<double> state(static_cast<std::size_t>(dimension));
      apply_move(move, c.states(), state.data());
      spread.whiten(state.data(), reference.data());
    }
  }
}

TEST(Apf, ScaleOfTheCoordinatesDoesNotMatter) {
  Cloud c = cloud(80, 2, 7);
  Apf apf;
  Rng rng(1), again(1);
  const auto moves = apf.find_moves(c.states(), c.weights, c.counts, rng);
  const std::vector<MovedParticle> first(moves.begin(), moves.end());
  for (std::size_t i = 0; i < c.values.size(); i += 2) c.values[i] *= 1000.0;
  const auto second = apf.find_moves(c.states(), c.weights, c.counts, again);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].toward, second[i].toward);
}

TEST(Apf, RefusesWhatDoesNotFit) {
  Cloud c = cloud(10, 1, 8);
  std::vector<std::uint32_t> ancestors(10);
  Apf apf;
  Rng rng(1);
  c.counts[0] += 1;
  EXPECT_THROW(apf.optimise(c.states(), c.weights, c.counts, ancestors, rng), std::invalid_argument);
  EXPECT_THROW(apf.find_moves(c.states(), std::span(c.weights).first(9), c.counts, rng), std::invalid_argument);
}

TEST(Apf, AllStatesAtOnePointStayThere) {
  const std::vector<double> values(60, 1.5), weights = cloud(20, 1, 9).weights;
  std::vector<std::uint32_t> counts = cloud(20, 1, 9).counts, ancestors(20);
  Apf apf;
  Rng rng(1);
  for (const int dimension : {1, 3}) {
    const States states{values.data(), 20, dimension, 0};
    for (const MovedParticle& move : apf.find_moves(states, weights, counts, rng)) {
      double state[3];
      apply_move(move, states, state);
      EXPECT_EQ(state[0], 1.5);
    }
  }
}

std::vector<Pose2> poses_of(const Cloud& c) {
  std::vector<Pose2> poses;
  for (std::size_t i = 0; i < c.weights.size(); ++i)
    poses.push_back({c.states()[i][0], c.states()[i][1], c.states()[i][2]});
  return poses;
}

TEST(PoseApf, AMovedPoseTakesItsOwnMapOrThatOfItsNeighbour) {
  const Cloud c = cloud(100, 3, 10, 0b100, 3.1);
  const std::vector<Pose2> poses = poses_of(c);
  Apf apf;
  std::size_t moved = 0;
  std::vector<PoseSlot> own, neighbour;
  for (auto* slots : {&own, &neighbour}) {
    std::vector<std::uint32_t> counts = c.counts;
    Rng rng(10);
    *slots = apf_slots(apf, poses, c.weights, counts, slots == &own ? MapOf::own : MapOf::neighbour, rng);
  }
  for (std::size_t i = 0; i < own.size(); ++i) {
    EXPECT_EQ(own[i].pose, neighbour[i].pose);
    EXPECT_EQ(own[i].moved, neighbour[i].moved);
    if (own[i].moved) {
      ++moved;
      EXPECT_EQ(own[i].ancestor, i);
      EXPECT_EQ(c.counts[own[i].ancestor], 0u);
      EXPECT_GT(c.counts[neighbour[i].ancestor], 0u);
      EXPECT_EQ(neighbour[neighbour[i].ancestor].ancestor, neighbour[i].ancestor);  // it stays in place
    } else {
      EXPECT_EQ(own[i].pose, poses[own[i].ancestor]);
    }
  }
  EXPECT_GT(moved, 3u);
}

TEST(PoseApf, IncrementsMoveBetweenThoseOfTheParticles) {
  const Cloud c = cloud(100, 3, 11, 0b100, 0.0);
  const std::vector<Pose2> increments = poses_of(c);
  Apf apf;
  Rng rng(11);
  const auto moves = apf_increments(apf, increments, c.weights, c.counts, rng);
  EXPECT_GT(moves.size(), 3u);
  for (const IncrementMove& move : moves) {
    EXPECT_EQ(c.counts[move.particle], 0u);
    EXPECT_TRUE(move.increment.finite());
  }
}

}  // namespace
}  // namespace noctule::particle
