#include "mapping/echo_fit.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "core/rng.hpp"
#include "mapping/echo_model.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::mapping {
namespace {

/// Echoes of a reflector from along an L-shaped path, one a stop.
std::vector<SonarArc> echoes(const Reflector& reflector, int count, double sigma, std::uint64_t seed) {
  Rng rng(seed, stream_id("test.echoes"));
  std::vector<SonarArc> arcs;
  for (int i = 0; i < count; ++i) {
    const double s = 1.6 * i / count;
    const Vector2 p = s < 0.8 ? Vector2(s, 0.0) : Vector2(0.8, s - 0.8);
    const Reflector::Sight sight = reflector.sight(p);
    arcs.push_back({.sensor = p,
                    .axis = sight.direction,
                    .range = sight.range + rng.normal(0.0, sigma),
                    .sigma = std::max(sigma, 0.005),
                    .half_angle = radians(15.0),
                    .stop = i});
  }
  return arcs;
}

std::vector<int> all(const std::vector<SonarArc>& arcs) {
  std::vector<int> members(arcs.size());
  std::iota(members.begin(), members.end(), 0);
  return members;
}

TEST(Reflector, SeesWhatTheRangeModelSees) {
  Rng rng(3);
  for (int i = 0; i < 100; ++i) {
    const Vector2 p(rng.uniform(-1, 1), rng.uniform(-1, 1));
    const Wall wall{rng.uniform(1.5, 3), rng.uniform(-3, 3)};
    const Cylinder cylinder{{rng.uniform(2, 3), rng.uniform(-3, 3)}, rng.uniform(0.05, 0.4)};
    const auto w = models::predict_echo(p, wall);
    const auto ws = Reflector(wall).sight(p);
    EXPECT_NEAR(ws.range, w.range, 1e-12);
    EXPECT_NEAR(wrap(std::atan2(ws.direction.y(), ws.direction.x()) - w.direction), 0.0, 1e-12);
    EXPECT_NEAR((Reflector(wall).gradient(p, ws).head<2>() - w.range_by_feature.transpose()).norm(), 0.0, 1e-12);
    const auto c = models::predict_echo(p, cylinder);
    const auto cs = Reflector(cylinder).sight(p);
    EXPECT_NEAR(cs.range, c.range, 1e-12);
    EXPECT_NEAR((Reflector(cylinder).gradient(p, cs) - c.range_by_feature.transpose()).norm(), 0.0, 1e-12);
  }
}

TEST(FitEchoes, RecoversEachKindExactlyFromAPoorStart) {
  const Reflector wall(Wall{1.5, 0.7}), cylinder(Cylinder{{1.5, 1.2}, 0.15}), point(Cylinder{{1.4, 1.1}, 0.0});
  for (const Reflector& truth : {wall, cylinder, point}) {
    const auto arcs = echoes(truth, 40, 0.0, 1);
    const auto fit = fit_echoes({truth.moved({0.01, 0.01, 0.01}), 1.0}, arcs, all(arcs), {}, 1e-10);
    ASSERT_TRUE(fit);
    for (const SonarArc& arc : arcs) EXPECT_NEAR(fit->reflector.sight(arc.sensor).range, arc.range, 1e-9);
  }
}

TEST(FitEchoes, IgnoresGrossErrors) {
  const Reflector truth(Wall{1.5, 0.7});
  auto arcs = echoes(truth, 60, 0.003, 2);
  for (std::size_t i = 0; i < arcs.size(); i += 5) arcs[i].range += 0.3;
  const auto fit = fit_echoes({truth.moved({0.02, 0.02, 0.0}), 1.0}, arcs, all(arcs), {}, 1e-8);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->reflector.wall().rho, 1.5, 0.005);
  EXPECT_NEAR(fit->reflector.wall().theta, 0.7, 0.005);
}

TEST(FitEchoes, CovarianceFollowsTheNoiseThatIsThere) {
  // The arcs claim 5 mm; the true noise is 15 mm.
  const Reflector truth(Wall{1.5, 0.7});
  Matrix2 sample = Matrix2::Zero(), predicted = Matrix2::Zero();
  constexpr int runs = 400;
  for (int run = 0; run < runs; ++run) {
    auto arcs = echoes(truth, 60, 0.015, 100 + static_cast<std::uint64_t>(run));
    for (SonarArc& arc : arcs) arc.sigma = 0.005;
    const auto fit = fit_echoes({truth, 3.0}, arcs, all(arcs), {}, 1e-8);
    ASSERT_TRUE(fit);
    const Vector2 e(fit->reflector.wall().rho - 1.5, wrap(fit->reflector.wall().theta - 0.7));
    sample += e * e.transpose() / runs;
    predicted += echo_covariance(*fit, arcs, all(arcs), {}).topLeftCorner<2, 2>() / runs;
  }
  EXPECT_NEAR(predicted(0, 0) / sample(0, 0), 1.0, 0.25);
  EXPECT_NEAR(predicted(1, 1) / sample(1, 1), 1.0, 0.25);
}

TEST(FitEchoes, CovarianceIsFiniteWhereOneStopDecides) {
  // 30 echoes within 10 cm of one stop fix the distance; a single other stop fixes the angle.
  const Reflector truth(Wall{1.5, 0.7});
  auto arcs = echoes(truth, 60, 0.003, 5);
  arcs.resize(31);
  Rng rng(5, stream_id("one stop"), 0, 0);
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    SonarArc& arc = arcs[i];
    arc.stop = i < 30 ? 0 : 1;
    arc.sensor = i < 30 ? Vector2(0.1 * rng.uniform(), 0.1 * rng.uniform()) : Vector2(-0.6, 0.7);
    const Reflector::Sight sight = truth.sight(arc.sensor);
    arc.range = sight.range + 0.003 * rng.normal();
    arc.axis = sight.direction;
  }
  const auto fit = fit_echoes({truth, 1.0}, arcs, all(arcs), {}, 1e-8);
  ASSERT_TRUE(fit);
  const Matrix3 covariance = echo_covariance(*fit, arcs, all(arcs), {});
  ASSERT_TRUE(covariance.allFinite());
  EXPECT_GT(covariance(0, 0), 0.0);
  EXPECT_GT(covariance(1, 1), 0.0);
  EXPECT_LT(covariance(1, 1), 0.1 * 0.1);
  EXPECT_EQ(covariance(2, 2), 0.0);
}

TEST(FitEchoes, SaysWhenTheEchoesDoNotSuffice) {
  const Reflector wall(Wall{1.5, 0.7});
  auto arcs = echoes(wall, 10, 0.0, 1);
  for (SonarArc& arc : arcs) {  // all from one place
    arc.sensor = Vector2::Zero();
    arc.range = 1.5;
  }
  EXPECT_FALSE(fit_echoes({wall, 1.0}, arcs, all(arcs), {}, 1e-8));
  EXPECT_FALSE(fit_echoes({wall, 1.0}, arcs, std::vector<int>{}, {}, 1e-8));
}

TEST(EchoModel, IsADensityOverRangeAndDirection) {
  const EchoModel model({}, {});
  const EchoFit fit{Reflector(Wall{1.5, 0.0}), 1.0};
  double mass = 0.0;
  constexpr double dr = 0.001, da = 0.002;
  for (double r = 1.2; r < 1.8; r += dr) {
    for (double a = -0.35; a < 0.35; a += da) {
      const SonarArc arc{.sensor = Vector2::Zero(),
                         .axis = {std::cos(a), std::sin(a)},
                         .range = r,
                         .sigma = 0.0105,
                         .half_angle = radians(15.0)};
      mass += std::exp(model.log_likelihood(fit, arc)) * dr * da;
    }
  }
  EXPECT_NEAR(mass, 1.0, 0.02);
  EXPECT_NEAR(model.log_clutter(), std::log(0.05 / 4.0 / kTwoPi), 1e-12);
}

}  // namespace
}  // namespace noctule::mapping
