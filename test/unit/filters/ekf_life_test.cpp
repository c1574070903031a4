/// Landmarks of EKF-SLAM that nobody names: they die where they are not seen, and are merged where they are one.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "filters/slam/ekf_slam.hpp"
#include "unit/filters/landmark_world.hpp"

namespace noctule::filters {
namespace {

EkfSlamParameters with_life() {
  EkfSlamParameters p;
  p.life.emplace();
  p.life->view_range = 25.0;
  p.life->view_half_angle = radians(85.0);
  return p;
}

void expect_sound(const EkfSlam& filter) {
  const Eigen::MatrixXd p = filter.covariance();
  EXPECT_TRUE(p.isApprox(p.transpose(), 1e-12));
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(p).eigenvalues().minCoeff(), -1e-9);
}

TEST(EkfLife, ClutterDiesAndLandmarksStay) {
  const auto world = test::small_web();
  std::size_t with = 0, without = 0;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EkfSlam mortal(with_life()), immortal({});
    Rng rng(seed, stream_id("test.clutter"));
    std::vector<char> seen(world.landmarks.size(), 0);
    for (auto& step : test::drive(world, 15.0, seed, 0.3)) {
      for (auto& d : step.detections.detections) {
        seen[static_cast<std::size_t>(d.id)] = 1;
        if (d.id % 2 == 1) d.id = -1;  // named and unnamed ones in one map
      }
      if (rng.uniform() < 0.2) {
        auto& d = step.detections.detections.emplace_back();
        d.range = rng.uniform(3.0, 25.0);
        d.bearing = rng.uniform(-1.0, 1.0);
        d.covariance.diagonal() << 0.04, 1e-3;
      }
      test::feed(mortal, step);
      test::feed(immortal, step);
    }
    expect_sound(mortal);
    with += mortal.map().landmarks.size();
    without += immortal.map().landmarks.size();
    for (std::size_t k = 0; k < world.landmarks.size(); k += 2) {
      if (seen[k] == 0) continue;
      for (const auto& l : mortal.map().landmarks) {
        if (l.id == static_cast<std::int64_t>(k)) {
          EXPECT_LT((l.parameters.head<2>() - world.landmarks[k]).norm(), 1.0);  // its name still leads to it
          ++found;
        }
      }
    }
  }
  EXPECT_GT(found, 30);
  EXPECT_LT(with, without - 20);
}

TEST(EkfLife, DuplicatesBecomeOne) {
  auto p = with_life();
  p.life->merge_gate = 4.0;
  p.life->confirm_above = 0.0;
  EkfSlam filter(p);
  const auto see = [&](double y, std::int64_t seq) {
    LandmarkDetections d{{seq, seq}, {}, {}};
    d.detections.push_back({.range = std::hypot(5.0, y), .bearing = std::atan2(y, 5.0)});
    d.detections[0].covariance.diagonal() << 1e-2, 1e-4;
    filter.update(d);
  };
  see(0.0, 0);
  see(1.0, 1);  // too far off: another one
  ASSERT_EQ(filter.covariance().rows(), 3 + 4);
  for (std::int64_t k = 0; k < 40; ++k) see(0.3, 2 + k);  // both come nearer to each other
  EXPECT_LE(filter.map().landmarks.size(), 2u);
  expect_sound(filter);

  EkfSlam two(p);  // as far from each other as their errors allow
  LandmarkDetections d{{0, 0}, {}, {}};
  d.detections.push_back({.range = 5.0, .bearing = 0.0});
  d.detections.push_back({.range = 5.15, .bearing = 0.0});
  for (auto& z : d.detections) z.covariance.diagonal() << 1e-2, 1e-4;
  two.update(d);
  ASSERT_EQ(two.map().landmarks.size(), 1u);
  EXPECT_NEAR(two.map().landmarks[0].parameters[0], 5.075, 1e-6);      // the mean of the two
  EXPECT_NEAR(two.map().landmarks[0].covariance(0, 0), 0.5e-2, 1e-6);  // and half the variance
  EXPECT_EQ(two.map().landmarks[0].observations, 2);
  expect_sound(two);
}

}  // namespace
}  // namespace noctule::filters
