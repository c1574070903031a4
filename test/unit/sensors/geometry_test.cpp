#include "sensors/ultrasonic/geometry.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/limits.hpp"
#include "core/rng.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::sensors {
namespace {

/// Noise-free sightings; with `hearing` the direction is known to 5 degrees, else not at all.
template <class Surface>
std::vector<Sighting> sightings(const std::vector<Vector2>& positions, const Surface& surface, bool hearing = true) {
  std::vector<Sighting> result;
  for (const Vector2& p : positions) {
    const auto echo = models::predict_echo(p, surface);
    Sighting s;
    s.position = p;
    s.range = echo.range;
    s.range_variance = 1e-6;
    s.direction = echo.direction;
    s.direction_variance = hearing ? std::pow(radians(5.0), 2) : kInf;
    result.push_back(s);
  }
  return result;
}

std::vector<Vector2> random_positions(Rng& rng, int n, double size = 0.5) {
  std::vector<Vector2> p;
  for (int i = 0; i < n; ++i) p.emplace_back(rng.uniform(-size, size), rng.uniform(-size, size));
  return p;
}
std::vector<Vector2> positions_on_a_line(Rng& rng, int n) {
  const Vector2 origin(rng.uniform(-1, 1), rng.uniform(-1, 1));
  const double heading = rng.uniform(-kPi, kPi);
  std::vector<Vector2> p;
  for (int i = 0; i < n; ++i) p.push_back(origin + 0.2 * (i + 1) * Vector2(std::cos(heading), std::sin(heading)));
  return p;
}

void expect_wall(const std::optional<Wall>& found, const Wall& truth) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->rho, truth.rho, 1e-9);
  EXPECT_NEAR(wrap(found->theta - truth.theta), 0.0, 1e-9);
}

TEST(TangentWall, IsExactWithoutNoiseAndNeedsNoDirectionOffTheLine) {
  Rng rng(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Wall wall{rng.uniform(1.0, 4.0), rng.uniform(-kPi, kPi)};
    expect_wall(tangent_wall(sightings(random_positions(rng, 3 + trial % 6), wall, false)), wall);
  }
}

TEST(TangentWall, DirectionsChooseBetweenMirrorImagesOnALine) {
  Rng rng(2);
  for (int trial = 0; trial < 500; ++trial) {
    const auto p = positions_on_a_line(rng, 2 + trial % 5);
    const Vector2 along = (p.back() - p.front()).normalized();
    const double theta = rng.uniform(-kPi, kPi);
    const Wall wall{3.0, theta};
    if (std::abs(wall.tangent().dot(along)) < 0.2) continue;  // nearly head-on: the images fall together
    expect_wall(tangent_wall(sightings(p, wall)), wall);
  }
}

TEST(TangentWall, ClampsRangesThatDifferByMoreThanTheBaseline) {
  auto s = sightings({{0.0, 0.0}, {0.1, 0.0}}, Wall{1.0, 0.0});
  s[0].range += 0.02;
  const auto wall = tangent_wall(s);
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->theta, 0.0, 1e-9);
}

TEST(TangentWall, LeastSquaresSolutionIsAMinimum) {
  Rng rng(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Wall truth{2.0, rng.uniform(-kPi, kPi)};
    auto s = sightings(random_positions(rng, 5), truth);
    for (Sighting& x : s) x.range += 0.02 * rng.normal(), x.direction_variance = kInf;
    const auto wall = tangent_wall(s);
    ASSERT_TRUE(wall);
    const double best = misfit(s, *wall);
    for (const double d : {-1e-4, 1e-4}) {
      double mean = 0.0;  // rho follows theta
      const Wall turned{0.0, wall->theta + d};
      for (const Sighting& x : s) mean += (x.range + turned.normal().dot(x.position)) / static_cast<double>(s.size());
      EXPECT_GE(misfit(s, Wall{mean, turned.theta}), best);
    }
    EXPECT_LE(best, misfit(s, truth));
  }
}

TEST(PointAtRanges, IsExactWithoutNoise) {
  Rng rng(4);
  for (int trial = 0; trial < 500; ++trial) {
    const double direction = rng.uniform(-kPi, kPi), distance = rng.uniform(1.0, 4.0);
    const Vector2 point = distance * Vector2(std::cos(direction), std::sin(direction));
    const Cylinder truth{point, 0.0};
    const auto found = point_at_ranges(sightings(random_positions(rng, 3 + trial % 6), truth, false));
    ASSERT_TRUE(found);
    EXPECT_LT((*found - point).norm(), 1e-9);
    const auto p = positions_on_a_line(rng, 2 + trial % 5);
    const Vector2 off = point - p.front(), along = (p.back() - p.front()).normalized();
    if (std::abs(off.x() * along.y() - off.y() * along.x()) < 0.3) continue;
    const auto on_line = point_at_ranges(sightings(p, truth));
    ASSERT_TRUE(on_line);
    EXPECT_LT((*on_line - point).norm(), 1e-9);
  }
}

TEST(Apollonius, IsExactWithoutNoise) {
  Rng rng(5);
  for (int trial = 0; trial < 500; ++trial) {
    const double direction = rng.uniform(-kPi, kPi), distance = rng.uniform(1.0, 2.0);
    const Cylinder truth{distance * Vector2(std::cos(direction), std::sin(direction)), rng.uniform(0.05, 0.3)};
    const auto found = apollonius(sightings(random_positions(rng, 4 + trial % 6), truth), 0.6);
    ASSERT_TRUE(found);
    EXPECT_LT((found->centre - truth.centre).norm(), 1e-9);
    EXPECT_NEAR(found->radius, truth.radius, 1e-9);
  }
}

TEST(Apollonius, IsExactForThreePositionsOnALine) {
  for (const double side : {-1.0, 1.0}) {
    const Cylinder truth{{0.3, 0.8 * side}, 0.12};
    const auto found = apollonius(sightings({{0.0, 0.0}, {0.4, 0.0}, {0.8, 0.0}}, truth), 0.6);
    ASSERT_TRUE(found);
    EXPECT_LT((found->centre - truth.centre).norm(), 1e-9);
    EXPECT_NEAR(found->radius, truth.radius, 1e-9);
  }
}

TEST(Apollonius, DropsTheRootOfNegativeRadius) {
  // Cylinder 1 of the indoor experiment, heard from three neighbouring places: the quadratic's second root has a
  // radius of -1.5 m.
  const Cylinder truth{{0.60, 0.60}, 0.106346};
  const auto found = apollonius(sightings({{0.0, 0.0}, {0.12, 0.0}, {0.20, 0.09}}, truth, false), 0.6);
  ASSERT_TRUE(found);
  EXPECT_LT((found->centre - truth.centre).norm(), 1e-9);
  EXPECT_NEAR(found->radius, truth.radius, 1e-9);
}

TEST(Apollonius, HasNoRootWithinTheLargestRadius) {
  const Cylinder truth{{1.5, 0.0}, 0.3};
  EXPECT_FALSE(apollonius(sightings({{0.0, 0.0}, {0.3, 0.4}, {0.2, -0.5}}, truth), 0.2));
}

TEST(ClosedForms, GiveNothingForTooFewOrCoincidentPositions) {
  const Wall wall{1.0, 0.0};
  const auto one = sightings({{0.0, 0.0}}, wall);
  const auto same = sightings({{0.1, 0.1}, {0.1, 0.1}, {0.1, 0.1}}, wall);
  for (const auto& s : {one, same}) {
    EXPECT_FALSE(tangent_wall(s));
    EXPECT_FALSE(point_at_ranges(s));
    EXPECT_FALSE(apollonius(s, 0.6));
  }
}

/// At that baseline the ranges of a point at broadside bend by three standard deviations of their second difference.
TEST(SeparatingBaseline, BendsThePointsRangesByThreeStandardDeviations) {
  for (const double range : {0.6, 1.0, 2.0}) {
    const double sigma = 0.003 + 0.005 * range, half = 0.5 * separating_baseline(range, sigma);
    EXPECT_NEAR(half * half / range, 3.0 * std::sqrt(6.0) * sigma, 1e-12);
    EXPECT_NEAR(2.0 * (std::hypot(range, half) - range), 3.0 * std::sqrt(6.0) * sigma, 0.1 * half * half / range);
  }
}

TEST(FrameChange, KeepsRangesAndTurnsDirections) {
  const Pose2 motion{0.3, -0.2, 0.7};
  const FrameChange change({motion, Matrix3::Zero()});
  const Wall wall{2.0, 0.4};
  const Cylinder cylinder{{1.0, 1.5}, 0.1};
  for (auto s : sightings({{0.1, 0.2}}, wall)) {
    Wall moved = wall;
    Matrix2 covariance = Matrix2::Identity();
    change.apply(s);
    change.apply(moved, covariance);
    EXPECT_NEAR(models::predict_echo(s.position, moved).range, s.range, 1e-12);
    EXPECT_NEAR(wrap(moved.theta - s.direction), 0.0, 1e-12);
  }
  for (auto s : sightings({{0.1, 0.2}}, cylinder)) {
    Cylinder moved = cylinder;
    Matrix3 covariance = Matrix3::Identity();
    change.apply(s);
    change.apply(moved, covariance);
    EXPECT_NEAR(models::predict_echo(s.position, moved).range, s.range, 1e-12);
    EXPECT_NEAR(covariance(2, 2), 1.0, 1e-12);
  }
}

/// The twists of stops, composed step by step, against the same composition done numerically.
TEST(FrameChange, DriftIsTheFirstOrderCovarianceOfDisplacedPositions) {
  const std::vector<Pose2> steps{{0.2, 0.0, 0.5}, {0.1, 0.05, -0.9}, {0.3, -0.1, 0.2}};
  std::vector<Matrix3> covariances;
  Rng rng(6);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    Matrix3 a;
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = 0.01 * rng.normal();
    covariances.push_back(a * a.transpose());
  }
  const Vector2 sensor(0.07, -0.04);
  Sighting s;
  s.position = sensor;
  for (std::size_t k = 0; k < steps.size(); ++k) FrameChange({steps[k], covariances[k]}).apply(s);
  Eigen::Matrix<double, 2, 3> g;
  g << 1.0, 0.0, -s.position.y(), 0.0, 1.0, s.position.x();
  const Matrix2 analytic = g * s.drift * g.transpose();

  Matrix2 numeric = Matrix2::Zero();
  const auto position = [&](std::size_t perturbed, const Vector3& d) {
    Pose2 total;
    for (std::size_t k = 0; k < steps.size(); ++k) {
      const Vector3 e = k == perturbed ? d : Vector3::Zero();
      total = total * Pose2{steps[k].x + e[0], steps[k].y + e[1], steps[k].yaw + e[2]};
    }
    return Vector2(inverse(total) * sensor);
  };
  for (std::size_t k = 0; k < steps.size(); ++k) {
    Eigen::Matrix<double, 2, 3> j;
    for (int i = 0; i < 3; ++i) {
      const Vector3 h = 1e-6 * Vector3::Unit(i);
      j.col(i) = (position(k, h) - position(k, -h)) / 2e-6;
    }
    numeric += j * covariances[k] * j.transpose();
  }
  EXPECT_LT((analytic - numeric).norm(), 1e-7 * numeric.norm());
}

}  // namespace
}  // namespace noctule::sensors
