/// Nothing depends on where the map's origin lies: start the filter elsewhere and everything moves along.
#include <gtest/gtest.h>

#include "unit/filters/recording.hpp"

namespace noctule::filters {
namespace {

Matrix3 rotation(double yaw) {
  Matrix3 r = Matrix3::Identity();
  r.topLeftCorner<2, 2>() << std::cos(yaw), -std::sin(yaw), std::sin(yaw), std::cos(yaw);
  return r;
}

TEST(RigidMotion, MovesEstimatePathAndMap) {
  const auto recording = test::record(test::corner_scene(), test::arc_path(25, 0.1, 0.1), test::noisy_drive(), 6);
  ParticleSlam reference(test::with_particles(80), 21);
  test::play(recording, reference);
  for (const Pose2& t : {Pose2{3.0, -1.0, 0.5}, Pose2{-40.0, 25.0, 3.0}, Pose2{0.0, 0.0, -2.0}}) {
    ParticleSlam moved(test::with_particles(80), 21, t);
    test::play(recording, moved);

    EXPECT_LT(difference(t * reference.estimate().pose, moved.estimate().pose).norm(), 1e-8);
    const Matrix3 r = rotation(t.yaw);
    EXPECT_TRUE((r * reference.estimate().covariance * r.transpose()).isApprox(moved.estimate().covariance, 1e-6));
    EXPECT_NEAR(reference.estimate().effective_sample_size, moved.estimate().effective_sample_size, 1e-5);
    EXPECT_NEAR(reference.estimate().nis, moved.estimate().nis, 1e-6);

    const auto path = reference.path().poses, path_moved = moved.path().poses;
    ASSERT_EQ(path.size(), path_moved.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      EXPECT_LT(difference(t * path[i].pose, path_moved[i].pose).norm(), 1e-8);
    }

    const auto map = reference.map().landmarks, map_moved = moved.map().landmarks;
    ASSERT_EQ(map.size(), map_moved.size());
    ASSERT_GE(map.size(), 3u);
    for (std::size_t k = 0; k < map.size(); ++k) {
      ASSERT_EQ(map[k].kind, map_moved[k].kind);
      if (map[k].kind == LandmarkKind::wall) {
        const Wall expected = normalised(transformed(t, Wall{map[k].parameters[0], map[k].parameters[1]}));
        EXPECT_NEAR(expected.rho, map_moved[k].parameters[0], 1e-7);
        EXPECT_NEAR(wrap(expected.theta - map_moved[k].parameters[1]), 0.0, 1e-7);
        // The distance from where the robot is has a variance that no change of frame alters.
        const auto variance = [](const LandmarkEstimate& l, const Pose2& from) {
          const Vector2 j(1.0, -Wall{0.0, l.parameters[1]}.tangent().dot(from.position()));
          return j.dot(l.covariance.topLeftCorner<2, 2>() * j);
        };
        EXPECT_NEAR(variance(map[k], reference.estimate().pose), variance(map_moved[k], moved.estimate().pose), 1e-9);
      } else {
        const Vector2 expected = t * Vector2(map[k].parameters.head<2>());
        EXPECT_LT((expected - map_moved[k].parameters.head<2>()).norm(), 1e-7);
        // r turns (x, y) and leaves the radius alone.
        const Matrix3 expected_covariance = r * map[k].covariance * r.transpose();
        EXPECT_TRUE(expected_covariance.isApprox(map_moved[k].covariance, 1e-6));
      }
    }
  }
}

}  // namespace
}  // namespace noctule::filters
