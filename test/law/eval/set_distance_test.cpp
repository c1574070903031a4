/// Set distances against brute force over all assignments, and the laws of a metric.
#include "eval/set_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "core/rng.hpp"
#include "eval/track_distance.hpp"

namespace noctule::eval {
namespace {

using Points = std::vector<Vector2>;

Points random_points(Rng& rng, int most) {
  Points points(static_cast<std::size_t>(rng.index(static_cast<std::uint64_t>(most) + 1)));
  for (Vector2& p : points) p = {rng.uniform(-10, 10), rng.uniform(-10, 10)};
  return points;
}

/// Least cost over all injections of the smaller set into the larger one; cost(d) of a pair.
double best_over_permutations(const Points& a, const Points& b, const std::function<double(double)>& cost) {
  const Points& small = a.size() <= b.size() ? a : b;
  const Points& large = a.size() <= b.size() ? b : a;
  std::vector<std::size_t> order(large.size());
  std::iota(order.begin(), order.end(), 0u);
  double best = std::numeric_limits<double>::infinity();
  do {
    double sum = 0.0;
    for (std::size_t i = 0; i < small.size(); ++i) sum += cost((small[i] - large[order[i]]).norm());
    best = std::min(best, sum);
  } while (std::ranges::next_permutation(order).found);
  return best;
}

constexpr SetDistanceParameters kKinds[] = {{1.0, 6.0}, {2.0, 6.0}, {3.5, 2.0}, {1.0, 50.0}};

TEST(SetDistanceLaws, EqualBruteForce) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    Rng rng(seed);
    const Points a = random_points(rng, 5), b = random_points(rng, 5);
    const double difference = std::abs(static_cast<double>(a.size()) - static_cast<double>(b.size()));
    const auto large = static_cast<double>(std::max(a.size(), b.size()));
    for (const auto& p : kKinds) {
      const double cp = std::pow(p.cutoff, p.order);
      const double cut =
          best_over_permutations(a, b, [&](double d) { return std::pow(std::min(d, p.cutoff), p.order); });
      const double expected = large > 0.0 ? std::pow((cut + cp * difference) / large, 1.0 / p.order) : 0.0;
      const Ospa o = ospa(a, b, p);
      EXPECT_NEAR(o.total, expected, 1e-9);
      EXPECT_NEAR(std::pow(o.total, p.order), std::pow(o.localisation, p.order) + std::pow(o.cardinality, p.order),
                  1e-9 * (1.0 + cp));
      EXPECT_NEAR(cola(a, b, p), std::pow(cut / cp + difference, 1.0 / p.order), 1e-9);

      const double gospa_expected = std::pow(cut + 0.5 * cp * difference, 1.0 / p.order);
      const Gospa g = gospa(a, b, p);
      EXPECT_NEAR(g.total, gospa_expected, 1e-9);
      EXPECT_NEAR(std::pow(g.total, p.order),
                  std::pow(g.localisation, p.order) + std::pow(g.missed, p.order) + std::pow(g.false_alarms, p.order),
                  1e-9 * (1.0 + cp));
      EXPECT_EQ(g.assigned_count + g.false_count, static_cast<int>(a.size()));
      EXPECT_EQ(g.assigned_count + g.missed_count, static_cast<int>(b.size()));
    }
  }
}

/// Identity, symmetry, triangle inequality, invariance under a common rigid motion and under reordering.
template <class Set, class Distance, class Make, class Move>
void expect_metric(Distance distance, Make make, Move move) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Rng rng(seed, 1);
    const Set a = make(rng), b = make(rng), c = make(rng);
    for (const auto& p : kKinds) {
      const double ab = distance(a, b, p);
      EXPECT_GE(ab, 0.0);
      EXPECT_NEAR(distance(a, a, p), 0.0, 1e-9);
      EXPECT_NEAR(distance(b, a, p), ab, 1e-9);
      EXPECT_LE(ab, distance(a, c, p) + distance(c, b, p) + 1e-9) << "seed " << seed;
      const Pose2 motion{3.0, -8.0, 1.1};
      EXPECT_NEAR(distance(move(a, motion), move(b, motion), p), ab, 1e-9);
      Set reordered = b;
      std::ranges::reverse(reordered);
      EXPECT_NEAR(distance(a, reordered, p), ab, 1e-9);
    }
  }
}

TEST(SetDistanceLaws, AreMetrics) {
  const auto make = [](Rng& rng) { return random_points(rng, 6); };
  const auto move = [](Points points, const Pose2& motion) {
    for (Vector2& q : points) q = motion * q;
    return points;
  };
  expect_metric<Points>([](const Points& a, const Points& b, const auto& p) { return ospa(a, b, p).total; }, make,
                        move);
  expect_metric<Points>([](const Points& a, const Points& b, const auto& p) { return gospa(a, b, p).total; }, make,
                        move);
  expect_metric<Points>([](const Points& a, const Points& b, const auto& p) { return cola(a, b, p); }, make, move);
}

TEST(SetDistanceLaws, OfTracksAreMetrics) {
  using Tracks = std::vector<Track>;
  const Window window{2, 9};
  const auto make = [](Rng& rng) {
    Tracks tracks(static_cast<std::size_t>(rng.index(5)));
    for (Track& t : tracks) {
      Vector2 at(rng.uniform(-6, 6), rng.uniform(-6, 6));
      for (int step = static_cast<int>(rng.index(8)); step < 12; ++step) {
        at += Vector2(rng.normal(), rng.normal());
        if (rng.uniform() < 0.8) t.push_back({step, at});
      }
    }
    return tracks;
  };
  const auto move = [](Tracks tracks, const Pose2& motion) {
    for (Track& t : tracks) {
      for (TrackPoint& q : t) q.position = motion * q.position;
    }
    return tracks;
  };
  expect_metric<Tracks>([&](const Tracks& a, const Tracks& b, const auto& p) { return ospa2(a, b, window, p).total; },
                        make, move);
}

}  // namespace
}  // namespace noctule::eval
