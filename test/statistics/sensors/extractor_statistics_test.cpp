#include <gtest/gtest.h>

#include <array>

#include "core/chi2.hpp"
#include "models/ultrasonic.hpp"
#include "statistics/sensors/scene.hpp"

namespace noctule::sensors {
namespace {

using scene::Kind;

constexpr double kRangeSd = 0.004, kDirectionSd = radians(3.0);

template <class Surface>
Sighting ideal(const Vector2& position, const Surface& surface, Rng& rng) {
  const auto echo = models::predict_echo(position, surface);
  Sighting s;
  s.position = position;
  s.range = echo.range + kRangeSd * rng.normal();
  s.range_variance = kRangeSd * kRangeSd;
  s.direction = wrap(echo.direction + kDirectionSd * rng.normal());
  s.direction_variance = kDirectionSd * kDirectionSd;
  return s;
}

const std::array<Vector2, 6> kPositions{Vector2{0.0, 0.0}, Vector2{0.2, 0.05},  Vector2{0.4, 0.05},
                                        Vector2{0.6, 0.0}, Vector2{0.75, -0.1}, Vector2{0.9, -0.2}};

/// Sample covariance of `fit` over many draws against the covariance that it claims, entry by entry in units of the
/// claimed standard deviations.
template <int D, class Draw>
void expect_covariance(const VectorD<D>& truth, const Draw& draw) {
  constexpr int kRuns = 4000;
  MatrixD<D> sample = MatrixD<D>::Zero(), claimed = MatrixD<D>::Zero();
  for (int run = 0; run < kRuns; ++run) {
    Rng rng(1, stream_id("covariance"), static_cast<std::uint64_t>(run));
    const auto fit = draw(rng);
    ASSERT_TRUE(fit);
    const VectorD<D> e = fit->parameters - truth;
    sample += e * e.transpose() / kRuns;
    claimed += fit->covariance / kRuns;
  }
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      EXPECT_NEAR(sample(i, j), claimed(i, j), 0.1 * std::sqrt(claimed(i, i) * claimed(j, j))) << i << ", " << j;
}

template <class Surface>
std::vector<Sighting> ideal_drive(const Surface& surface, Rng& rng) {
  std::vector<Sighting> s;
  for (const Vector2& p : kPositions) s.push_back(ideal(p, surface, rng));
  return s;
}

TEST(FitStatistics, WallCovarianceIsThatOfManyDraws) {
  const Wall wall{1.2, radians(75.0)};
  expect_covariance<2>({wall.rho, wall.theta}, [&](Rng& rng) { return fit_wall(ideal_drive(wall, rng), wall); });
}

TEST(FitStatistics, PointCovarianceIsThatOfManyDraws) {
  const Cylinder point{{0.5, 0.9}, 0.0};
  expect_covariance<2>(point.centre, [&](Rng& rng) { return fit_point(ideal_drive(point, rng), point.centre); });
}

TEST(FitStatistics, CylinderCovarianceIsThatOfManyDraws) {
  const Cylinder cylinder{{0.5, 0.5}, 0.12};
  expect_covariance<3>({0.5, 0.5, 0.12}, [&](Rng& rng) { return fit_cylinder(ideal_drive(cylinder, rng), cylinder); });
}

/// Average NEES of a wall (rho, theta) and chi2 per degree of freedom, over a drive with turns whose odometry is
/// noisy; in the frame of the last stop. Without `drift` the fit is told that the odometry is perfect.
struct Consistency {
  double wall_nees = 0.0, cylinder_nees = 0.0, chi2_per_dof = 0.0;
};
Consistency consistency(int runs, bool drift) {
  const Wall wall{1.5, radians(70.0)};
  const Cylinder cylinder{{0.6, 0.9}, 0.12};
  const models::OdometryNoise noise;
  Consistency c;
  for (int run = 0; run < runs; ++run) {
    Rng rng(2, stream_id("nees"), static_cast<std::uint64_t>(run));
    std::vector<Sighting> walls, cylinders;
    Pose2 base;
    for (int k = 0; k < 9; ++k) {
      if (k > 0) {
        const double turn = k % 3 == 0 ? 0.5 : 0.0;
        const Pose2 step{0.15, 0.0, turn};
        const Matrix3 q = noise.straight(0.15) + (turn != 0.0 ? noise.turn_on_the_spot() : Matrix3::Zero().eval());
        const Vector3 e = sample_gaussian<3>(square_root<3>(q), rng);
        base = base * Pose2{step.x + e[0], step.y + e[1], step.yaw + e[2]};
        const FrameChange change({step, drift ? q : Matrix3::Zero().eval()});
        for (Sighting& s : walls) change.apply(s);
        for (Sighting& s : cylinders) change.apply(s);
      }
      const Vector2 mount(0.05, 0.02);
      Cylinder here = cylinder;
      here.centre = inverse(base) * cylinder.centre;
      walls.push_back(ideal(mount, transformed(inverse(base), wall), rng));
      cylinders.push_back(ideal(mount, here, rng));
    }
    const Wall wall_here = transformed(inverse(base), wall);
    const Vector2 centre_here = inverse(base) * cylinder.centre;
    const auto w = fit_wall(walls, wall_here);
    const auto a = fit_cylinder(cylinders, {centre_here, cylinder.radius});
    EXPECT_TRUE(w && a);
    if (!w || !a) continue;
    const Vector2 ew(w->parameters[0] - wall_here.rho, wrap(w->parameters[1] - wall_here.theta));
    Vector3 ea;
    ea << a->parameters.head<2>() - centre_here, a->parameters[2] - cylinder.radius;
    c.wall_nees += mahalanobis2<2>(ew, w->covariance) / runs;
    c.cylinder_nees += mahalanobis2<3>(ea, a->covariance) / runs;
    c.chi2_per_dof += 0.5 * (w->chi2 / w->dof + a->chi2 / a->dof) / runs;
  }
  return c;
}

TEST(FitStatistics, NeesIsInBoundsWithNoisyOdometry) {
  constexpr int kRuns = 400;
  const Consistency c = consistency(kRuns, true);
  const Interval two = nees_bounds(2, kRuns, 0.999), three = nees_bounds(3, kRuns, 0.999);
  EXPECT_GT(c.wall_nees, two.low);
  EXPECT_LT(c.wall_nees, two.high);
  EXPECT_GT(c.cylinder_nees, three.low);
  EXPECT_LT(c.cylinder_nees, three.high);
  EXPECT_NEAR(c.chi2_per_dof, 1.0, 0.05);
}

TEST(FitStatistics, AFitThatTrustsTheOdometryFailsTheSameTest) {
  constexpr int kRuns = 400;
  const Consistency c = consistency(kRuns, false);
  EXPECT_GT(c.wall_nees, nees_bounds(2, kRuns, 0.999).high);
  EXPECT_GT(c.chi2_per_dof, 1.2);
}

/// From raw scans to parameters: noise known by nominal value only, the directions from which pings answered.
TEST(ExtractorStatistics, WallNeesFromScansIsNearTwo) {
  constexpr int kRuns = 300;
  double nees = 0.0;
  int count = 0;
  for (int run = 0; run < kRuns; ++run) {
    Rng rng(3, stream_id("scans"), static_cast<std::uint64_t>(run));
    const scene::Object wall = scene::place(Kind::wall, 1.0, radians(30.0), rng);
    const scene::Drive drive = scene::drive(wall, 9, 0.8, {}, {}, rng);
    const ContourFeature* best = nullptr;
    const auto features = extract(drive.scans, {});
    for (const auto& f : features)
      if (!best || f.stops > best->stops) best = &f;
    if (!best || !best->has_wall) continue;
    const Wall truth = transformed(inverse(drive.last), wall.wall);
    const Vector2 e(best->wall.rho - truth.rho, wrap(best->wall.theta - truth.theta));
    nees += mahalanobis2<2>(e, best->wall_covariance);
    ++count;
  }
  EXPECT_GE(count, kRuns * 95 / 100);
  // The directions are no Gaussians and the noise scale is estimated: 15 % beyond the bounds of an ideal estimator.
  const Interval bounds = nees_bounds(2, count, 0.999);
  EXPECT_GT(nees / count, bounds.low / 1.15);
  EXPECT_LT(nees / count, bounds.high * 1.15);
}

TEST(ExtractorStatistics, WrongTypesAreRareAtTheSensibleBaseline) {
  constexpr int kRuns = 60;
  int wrong = 0, walls = 0, curved = 0;
  for (const double scale : {1.0, 4.0}) {
    for (const Kind kind : {Kind::wall, Kind::cylinder, Kind::corner}) {
      for (int run = 0; run < kRuns; ++run) {
        Rng rng(4, stream_id("types"), static_cast<std::uint64_t>(run));
        scene::Ranger ranger;
        ranger.scale = scale;
        const scene::Object object = scene::place(kind, 1.0, radians(30.0), rng);
        const double length = separating_baseline(1.0, scale * ranger.noise.sd(1.0));
        const scene::Drive drive = scene::drive(object, 9, length, ranger, {}, rng);
        const ContourFeature* best = nullptr;
        const auto features = extract(drive.scans, {});
        for (const auto& f : features)
          if (!best || f.stops > best->stops) best = &f;
        if (!best) continue;
        if (kind == Kind::wall) {
          walls += best->type == ContourType::wall;
          wrong += !best->has_wall;
        } else {
          curved += !best->has_wall;
          wrong += best->type == ContourType::wall;
          wrong += best->type == (kind == Kind::cylinder ? ContourType::point : ContourType::arc);
        }
      }
    }
  }
  EXPECT_LE(wrong, 6 * kRuns * 2 / 100);
  EXPECT_GE(walls, 2 * kRuns * 90 / 100);
  EXPECT_GE(curved, 4 * kRuns * 90 / 100);
}

}  // namespace
}  // namespace noctule::sensors
