#include "eval/trajectory3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/rng.hpp"

namespace noctule::eval {
namespace {

Eigen::Quaterniond random_rotation(Rng& rng) {
  return Eigen::Quaterniond(rng.normal(), rng.normal(), rng.normal(), rng.normal()).normalized();
}
Vector3 random_vector(Rng& rng) {
  return {rng.normal(), rng.normal(), rng.normal()};
}

/// An estimate that errs by about 0.1 m and 0.05 rad.
std::vector<PosePair3> noisy_pairs3(std::uint64_t seed, bool planar = false) {
  Rng rng(seed);
  std::vector<PosePair3> pairs;
  Pose3 truth{{1, 2, 0}, Eigen::Quaterniond::Identity()};
  for (int i = 0; i < 100; ++i) {
    const auto motion = [&](double step, double way, double turn) {
      Pose3 p{{step + way * rng.normal(), way * rng.normal(), way * rng.normal()},
              Eigen::AngleAxisd(turn * rng.normal(), random_vector(rng).normalized()) *
                  Eigen::Quaterniond(Eigen::AngleAxisd(0.4 * step, Vector3::UnitZ()))};
      return planar ? in_space(in_plane(p)) : p;
    };
    truth = truth * motion(0.2, 0.05, 0.1);
    pairs.push_back({i * 100'000, truth * motion(0.0, 0.1, 0.05), truth});
  }
  return pairs;
}

double rms(const std::vector<double>& errors) {
  double sum = 0.0;
  for (const double e : errors) sum += e * e;
  return std::sqrt(sum / static_cast<double>(errors.size()));
}

TEST(Pose3, ComposesAndProjects) {
  Rng rng(1);
  const Pose3 a{random_vector(rng), random_rotation(rng)}, b{random_vector(rng), random_rotation(rng)};
  const Pose3 back = a * between(a, b);
  EXPECT_LT((back.position - b.position).norm(), 1e-14);
  EXPECT_LT(back.rotation.angularDistance(b.rotation), 1e-7);
  const Pose2 p{1.0, -2.0, 2.5}, q{0.3, 0.4, -2.0};
  EXPECT_LT(difference(in_plane(in_space(p)), p).norm(), 1e-14);
  EXPECT_LT(difference(in_plane(in_space(p) * in_space(q)), p * q).norm(), 1e-14);
}

TEST(Align3, RecoversAKnownMotion) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed);
    const Similarity3 truth{rng.uniform(0.3, 3.0), random_rotation(rng).toRotationMatrix(), random_vector(rng)};
    std::vector<Vector3> source, target, scaled;
    for (int i = 0; i < 4; ++i) {
      source.push_back(random_vector(rng));
      scaled.push_back(truth * source.back());
      target.push_back(truth.rotation * source.back() + truth.translation);
    }
    const Similarity3 similar = align(source, scaled, Alignment3::similarity);
    EXPECT_NEAR(similar.scale, truth.scale, 1e-10);
    EXPECT_LT((similar.rotation - truth.rotation).norm(), 1e-10);
    EXPECT_LT((similar.translation - truth.translation).norm(), 1e-10);
    const Similarity3 rigid = align(source, target, Alignment3::rigid);
    EXPECT_EQ(rigid.scale, 1.0);
    EXPECT_LT((rigid.rotation - truth.rotation).norm(), 1e-10);
  }
}

TEST(Align3, NeverReflects) {
  const std::vector<Vector3> source{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  std::vector<Vector3> mirrored = source;
  for (Vector3& p : mirrored) p.x() = -p.x();
  for (const Alignment3 a : {Alignment3::rigid, Alignment3::similarity, Alignment3::yaw}) {
    EXPECT_NEAR(align(source, mirrored, a).rotation.determinant(), 1.0, 1e-12);
  }
}

TEST(Align3, YawLeavesTheVerticalAlone) {
  Rng rng(2);
  const Matrix3 turn = Eigen::AngleAxisd(-2.0, Vector3::UnitZ()).toRotationMatrix();
  std::vector<Vector3> source, target;
  for (int i = 0; i < 6; ++i) {
    source.push_back(random_vector(rng));
    target.push_back(turn * source.back() + Vector3(1, 2, 3));
  }
  const Similarity3 s = align(source, target, Alignment3::yaw);
  EXPECT_LT((s.rotation - turn).norm(), 1e-12);
  EXPECT_LT((s.translation - Vector3(1, 2, 3)).norm(), 1e-12);
}

TEST(Align3, DegenerateInput) {
  EXPECT_EQ(align(std::span<const Vector3>{}, {}, Alignment3::rigid).rotation, Matrix3(Matrix3::Identity()));
  const std::vector<Vector3> one{{1, 2, 3}}, other{{2, 2, 2}};
  const Similarity3 s = align(one, other, Alignment3::similarity);
  EXPECT_EQ(s.scale, 1.0);
  EXPECT_LT((s * one[0] - other[0]).norm(), 1e-12);
  EXPECT_THROW((void)align(one, std::span<const Vector3>{}, Alignment3::rigid), std::invalid_argument);
}

/// Umeyama in space and the closed form in the plane find the same for data in the plane.
TEST(Align3, OfThePlaneIsThePlanarOne) {
  const auto pairs = noisy_pairs3(3, true);
  std::vector<PosePair> planar;
  for (const PosePair3& p : pairs) planar.push_back({p.utime, in_plane(p.estimate), in_plane(p.truth)});
  EXPECT_NEAR(rms(absolute_errors(aligned(pairs, align(pairs, Alignment3::rigid))).translation),
              absolute_trajectory_error(planar, Alignment::rigid), 1e-12);
  EXPECT_NEAR(rms(absolute_errors(aligned(pairs, align(pairs, Alignment3::similarity))).translation),
              absolute_trajectory_error(planar, Alignment::similarity), 1e-12);
  EXPECT_NEAR(rms(absolute_errors(pairs).translation), pose_errors(planar).position_rmse, 1e-12);
  EXPECT_NEAR(rms(absolute_errors(pairs).rotation), pose_errors(planar).heading_rmse, 1e-12);
  const auto segments = segments_by_distance(travelled(pairs), 1.0, SegmentStarts::every_pose);
  const RelativePoseErrors relative = relative_pose_errors(planar, segments);
  EXPECT_NEAR(rms(relative_errors(pairs, segments).translation), relative.translation_rmse, 1e-12);
  EXPECT_NEAR(rms(relative_errors(pairs, segments).rotation), relative.rotation_rmse, 1e-12);
}

TEST(Trajectory3, ErrorsSurviveMotions) {
  const auto pairs = noisy_pairs3(4);
  Rng rng(5);
  const Similarity3 motion{1.0, random_rotation(rng).toRotationMatrix(), random_vector(rng)};
  const auto moved = aligned(pairs, motion);
  const auto ate = [](const auto& p) {
    return rms(absolute_errors(aligned(p, align(p, Alignment3::rigid))).translation);
  };
  EXPECT_NEAR(ate(moved), ate(pairs), 1e-12);
  EXPECT_LE(ate(pairs), rms(absolute_errors(pairs).translation));
  const auto segments = segments_by_steps(pairs.size(), 7, SegmentStarts::every_pose);
  EXPECT_NEAR(rms(relative_errors(moved, segments).translation), rms(relative_errors(pairs, segments).translation),
              1e-12);
  EXPECT_NEAR(rms(relative_errors(moved, segments).rotation), rms(relative_errors(pairs, segments).rotation), 1e-12);
}

TEST(Trajectory3, RotationErrorIsTheAngle) {
  Rng rng(6);
  for (const double angle : {1e-9, 0.3, 3.1}) {
    const Pose3 truth{Vector3::Zero(), random_rotation(rng)};
    Pose3 estimate = truth;
    estimate.rotation = truth.rotation * Eigen::AngleAxisd(angle, random_vector(rng).normalized());
    estimate.rotation.coeffs() *= -1.0;  // the same rotation
    const std::vector<PosePair3> pairs{{0, estimate, truth}};
    EXPECT_NEAR(absolute_errors(pairs).rotation[0], angle, 1e-14);
  }
}

TEST(Associate3, NearestInTimeFromTheShorterTrajectory) {
  const auto at = [](std::int64_t utime, double x) {
    return TimedPose3{utime, {{x, 0, 0}, Eigen::Quaterniond::Identity()}};
  };
  const std::vector<TimedPose3> truth{at(0, 0), at(10'000, 1), at(20'000, 2), at(500'000, 50)};
  const std::vector<TimedPose3> estimate{at(14'000, 1), at(15'000, 1.5), at(300'000, 9)};
  auto pairs = associate_nearest(estimate, truth);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].truth.position.x(), 1.0);
  EXPECT_EQ(pairs[1].truth.position.x(), 1.0);  // equally near: the earlier
  pairs = associate_nearest(truth, estimate, 0.011);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].estimate.position.x(), 1.0);
  EXPECT_EQ(pairs[0].truth.position.x(), 1.0);
  EXPECT_TRUE(associate_nearest({}, truth).empty());
}

TEST(Associate3, InterpolatesTheTruth) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.0, Vector3::UnitX()));
  const std::vector<TimedPose3> truth{{0, {}}, {1'000'000, {{4, 0, 2}, turn}}};
  const std::vector<TimedPose3> estimate{{-1, {}}, {250'000, {}}, {1'000'000, {}}, {1'000'001, {}}};
  const auto pairs = associate_interpolated(estimate, truth);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_LT((pairs[0].truth.position - Vector3(1, 0, 0.5)).norm(), 1e-12);
  EXPECT_NEAR(pairs[0].truth.rotation.angularDistance(Eigen::Quaterniond::Identity()), 0.25, 1e-9);
  EXPECT_TRUE(associate_interpolated(estimate, truth, 0.5).size() == 1);
}

TEST(Drift, OfAnOdometerThatScalesAndTurns) {
  std::vector<PosePair3> pairs;
  for (int i = 0; i <= 100; ++i) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.001 * i, Vector3::UnitX()));
    pairs.push_back({i, {{1.02 * i, 0, 0}, turn}, {{1.0 * i, 0, 0}, Eigen::Quaterniond::Identity()}});
  }
  const std::vector<double> lengths{10.0, 20.0, 1000.0};
  const Drift d = drift(pairs, lengths);
  EXPECT_EQ(d.segments, 91 + 81);
  EXPECT_NEAR(d.translation, 0.02, 1e-12);
  EXPECT_NEAR(d.rotation, 0.001, 1e-9);
  EXPECT_EQ(drift(pairs, lengths, 10).segments, 10 + 9);
  EXPECT_TRUE(std::isnan(drift({}, lengths).translation));
  EXPECT_THROW((void)drift(pairs, lengths, 0), std::invalid_argument);
}

}  // namespace
}  // namespace noctule::eval
