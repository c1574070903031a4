/// The branch and bound finds what trying everything finds.
#include "filters/slam/joint_compatibility.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/chi2.hpp"
#include "core/limits.hpp"
#include "core/rng.hpp"
#include "filters/slam/ekf_slam.hpp"
#include "filters/slam/make_slam_filter.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

struct Problem {
  std::vector<Pairing> pairings;
  Eigen::VectorXd innovations;
  Eigen::MatrixXd covariance;

  [[nodiscard]] double distance2(const std::vector<std::size_t>& set) const {
    const auto n = static_cast<Eigen::Index>(2 * set.size());
    Eigen::MatrixXd s(n, n);
    Eigen::VectorXd v(n);
    for (std::size_t a = 0; a < set.size(); ++a) {
      const auto i = static_cast<Eigen::Index>(2 * a), at = static_cast<Eigen::Index>(2 * set[a]);
      v.segment<2>(i) = innovations.segment<2>(at);
      for (std::size_t b = 0; b < set.size(); ++b) {
        s.block<2, 2>(i, static_cast<Eigen::Index>(2 * b)) =
            covariance.block<2, 2>(at, static_cast<Eigen::Index>(2 * set[b]));
      }
    }
    return n == 0 ? 0.0 : v.dot(s.llt().solve(v));
  }
};

/// Innovations that share an error, as those of one pose do.
Problem random_problem(std::uint64_t seed) {
  Rng rng(seed, stream_id("test.jcbb"));
  Problem p;
  const std::size_t sightings = 1 + rng.index(4), landmarks = 1 + rng.index(4);
  for (std::size_t i = 0; i < sightings; ++i) {
    for (std::size_t j = 0; j < landmarks; ++j) {
      if (rng.uniform() < 0.7) p.pairings.push_back({i, j, rng.uniform() < 0.8 ? 2 : 1});
    }
  }
  const auto n = static_cast<Eigen::Index>(2 * p.pairings.size());
  Eigen::MatrixXd common(n, 3);
  p.innovations.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) common(i, k) = rng.normal();
    p.innovations[i] = rng.normal(0.0, 1.8);
  }
  for (std::size_t k = 0; k < p.pairings.size(); ++k) {
    if (p.pairings[k].numbers == 2) continue;
    common.row(static_cast<Eigen::Index>(2 * k)).setZero();
    p.innovations[static_cast<Eigen::Index>(2 * k)] = 0.0;
  }
  p.covariance = common * common.transpose() + Eigen::MatrixXd::Identity(n, n);
  return p;
}

/// All sets, one after the other. Compatible means that its beginnings are too, in the order of the sightings.
void enumerate(const Problem& p, std::size_t sighting, std::vector<std::size_t>& set, double probability,
               std::vector<std::size_t>& best, double& best_distance2) {
  if (sighting == 4) {
    const double d2 = p.distance2(set);
    if (set.size() > best.size() || (set.size() == best.size() && d2 < best_distance2)) {
      best = set;
      best_distance2 = d2;
    }
    return;
  }
  enumerate(p, sighting + 1, set, probability, best, best_distance2);
  for (std::size_t k = 0; k < p.pairings.size(); ++k) {
    if (p.pairings[k].sighting != sighting) continue;
    if (std::ranges::any_of(set, [&](std::size_t j) { return p.pairings[j].landmark == p.pairings[k].landmark; })) {
      continue;
    }
    set.push_back(k);
    int numbers = 0;
    for (const std::size_t j : set) numbers += p.pairings[j].numbers;
    if (p.distance2(set) <= chi2_quantile(probability, numbers)) {
      enumerate(p, sighting + 1, set, probability, best, best_distance2);
    }
    set.pop_back();
  }
}

TEST(JointCompatibility, FindsWhatTryingEverythingFinds) {
  std::size_t larger = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const Problem p = random_problem(seed);
    std::vector<std::size_t> set, best;
    double best_distance2 = kInf;
    enumerate(p, 0, set, 0.95, best, best_distance2);
    const auto found = jointly_compatible(p.pairings, p.innovations, p.covariance, 0.95);
    EXPECT_EQ(found, best) << seed;
    EXPECT_NEAR(p.distance2(found), best.empty() ? 0.0 : best_distance2, 1e-9);
    larger += found.size() > 1;
  }
  EXPECT_GT(larger, 100u);
}

/// A robot that has lost its way a little, among landmarks that stand as far from each other as it is off: each
/// sighting alone fits the wrong neighbour better, all together fit but one way.
TEST(JointCompatibility, KeepsARowOfLandmarksApart) {
  for (const Matching matching : {Matching::joint, Matching::nearest}) {
    EkfSlamParameters p;
    p.sightings.match = matching;
    EkfSlam filter(p);
    const auto see = [&](double shift, std::int64_t seq) {
      LandmarkDetections d{{seq, seq}, {}, {}};
      for (int k = 0; k < 5; ++k) {
        const double x = 5.0, y = -2.0 + (k == 4 ? 3.4 : 1.0 * k) - shift;
        d.detections.push_back({.range = std::hypot(x, y), .bearing = std::atan2(y, x)});
        d.detections.back().covariance.diagonal() << 4e-4, 4e-5;
      }
      filter.update(d);
    };
    see(0.0, 0);
    Odometry o;
    o.covariance.diagonal() << 1e-6, 0.5, 1e-6;
    filter.predict(o);
    see(0.6, 1);  // the robot is 0.6 m to the left of where it thinks, the landmarks 1 m apart
    if (matching == Matching::joint) {
      EXPECT_EQ(filter.map().landmarks.size(), 5u);
      EXPECT_NEAR(filter.estimate().pose.y, 0.6, 0.05);
    } else {
      EXPECT_GT(std::abs(filter.estimate().pose.y - 0.6), 0.1);
    }
  }
}

/// Names that are wrong now and then do no harm where a gate is set.
TEST(NamedGate, DropsSightingsOfAnotherLandmark) {
  const auto world = test::small_web();
  FastSlam2Parameters fast;
  ParticleSlamParameters pf;
  EkfSlamParameters ekf;
  fast.particles = pf.particles = 50;
  const auto errors = [&](auto p, double gate) {
    p.sightings.named_gate = gate;
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      auto run = test::drive(world, 15.0, seed);
      Rng rng(seed, stream_id("test.names"));
      const auto filter = make_slam_filter(p, seed, {});
      for (auto& step : run) {
        auto& all = step.detections.detections;
        if (all.size() > 1 && step.detections.stamp.seq > 10 && rng.uniform() < 0.3) std::swap(all[0].id, all[1].id);
        test::feed(*filter, step);
      }
      sum += difference(filter->estimate().pose, run.back().truth).template head<2>().norm() / 5.0;
    }
    return sum;
  };
  EXPECT_LT(errors(ekf, 25.0), 0.5);
  EXPECT_LT(errors(fast, 25.0), 0.5);
  EXPECT_LT(errors(pf, 25.0), 1.0);
  EXPECT_GT(errors(ekf, 0.0), 2.0 * errors(ekf, 25.0));
}

}  // namespace
}  // namespace noctule::filters
