#include "filters/slam/point_maps.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "filters/slam/particle_kernel.hpp"
#include "filters/slam/particle_slam.hpp"
#include "models/range_bearing.hpp"

namespace noctule::filters {
namespace {

const std::vector<Vector2> kLandmarks{{3.0, 1.0}, {2.0, -2.0}, {-1.0, 2.5}, {4.0, 4.0}, {-2.0, -1.5}};

Matrix2 sighting_covariance() {
  return Vector2(0.01, 4e-4).asDiagonal();
}

/// All landmarks seen from `base`; ids are their indices, or unknown.
LandmarkDetections see(const Pose2& base, std::int64_t seq, bool known, double noise, Rng& rng) {
  LandmarkDetections d;
  d.stamp = {seq * 100000, seq};
  d.sensor_in_base = {0.1, 0.0, 0.2};
  for (std::size_t k = 0; k < kLandmarks.size(); ++k) {
    const auto z = models::predict_range_bearing(base * d.sensor_in_base, kLandmarks[k]).z;
    d.detections.push_back({.range = z[0] + noise * rng.normal(0.0, 0.1),
                            .bearing = z[1] + noise * rng.normal(0.0, 0.02),
                            .covariance = sighting_covariance(),
                            .id = known ? static_cast<std::int64_t>(k) : -1});
  }
  return d;
}

Odometry forward() {
  Odometry o;
  o.increment = {0.1, 0.0, 0.05};
  o.covariance.diagonal() << 4e-4, 1e-4, 4e-4;
  return o;
}

ParticleSlam filter_with(int particles) {
  ParticleSlamParameters p;
  p.particles = particles;
  return ParticleSlam(p, 9);
}

TEST(Sightings, OneParticleWithoutNoiseIsExact) {
  for (const bool known : {true, false}) {
    auto filter = filter_with(1);
    Pose2 base;
    Rng rng(1);
    for (int k = 0; k < 20; ++k) {
      auto o = forward();
      o.covariance.setZero();
      base = base * o.increment;
      filter.predict(o);
      filter.update(see(base, k, known, 0.0, rng));
    }
    EXPECT_LT(difference(filter.estimate().pose, base).norm(), 1e-12);
    const auto map = filter.map().landmarks;
    ASSERT_EQ(map.size(), kLandmarks.size());
    for (std::size_t k = 0; k < map.size(); ++k) {
      EXPECT_LT((map[k].parameters.head<2>() - kLandmarks[k]).norm(), 1e-9);
      EXPECT_EQ(map[k].observations, 20);
      EXPECT_TRUE(known ? map[k].id == static_cast<std::int64_t>(k) : map[k].id < -1);
    }
  }
}

TEST(Sightings, AssociationFindsTheIdentitiesOfWellSeparatedLandmarks) {
  ParticleSlamParameters p;
  p.particles = 50;
  p.sightings.gate = p.sightings.new_above = 50.0;  // so that chance drops no match ...
  p.sightings.new_density = 1e-12;                  // ... and none is better left free
  ParticleSlam known(p, 9), unknown(p, 9);
  Pose2 base;
  Rng noise_a(3), noise_b(3);
  for (int k = 0; k < 30; ++k) {
    base = base * forward().increment;
    known.predict(forward());
    unknown.predict(forward());
    known.update(see(base, k, true, 1.0, noise_a));
    unknown.update(see(base, k, false, 1.0, noise_b));
  }
  EXPECT_EQ(known.map().landmarks.size(), unknown.map().landmarks.size());
  EXPECT_LT(difference(known.estimate().pose, unknown.estimate().pose).norm(), 1e-9);
  EXPECT_LT(difference(known.estimate().pose, base).norm(), 0.2);
}

TEST(Sightings, OrderInTheMessageChangesNothing) {
  for (const bool are_known : {true, false}) {
    auto a = filter_with(30), b = filter_with(30);
    Pose2 base;
    Rng rng(4);
    for (int k = 0; k < 15; ++k) {
      base = base * forward().increment;
      auto message = see(base, k, are_known, 1.0, rng);
      a.predict(forward());
      a.update(message);
      std::ranges::rotate(message.detections, message.detections.begin() + 2);
      std::swap(message.detections[0], message.detections[3]);
      b.predict(forward());
      b.update(message);
      EXPECT_LT(difference(a.estimate().pose, b.estimate().pose).norm(), 1e-9);
      EXPECT_NEAR(a.estimate().effective_sample_size, b.estimate().effective_sample_size, 1e-6);
    }
  }
}

/// One particle at the origin that has seen one landmark, at (2, 0), of covariance 1e-4 I.
class OneLandmark {
 public:
  explicit OneLandmark(const SightingParameters& parameters) : points_(1, parameters) {
    LandmarkDetections first;
    first.detections.push_back({.range = 2.0, .covariance = Vector2(1e-4, 1e-4 / 4.0).asDiagonal().toDenseMatrix()});
    see(first);
  }
  ObservationFit see(const LandmarkDetections& d) {
    points_.begin(d, next_id_);
    points_.associate(std::vector<Pose2>(1), {});
    points_.make_writable();
    return update_map(points_.view(0), {}, KalmanUpdate{});
  }
  [[nodiscard]] std::size_t size() const { return points_.maps().size(0); }
  [[nodiscard]] const PointLandmark& at(std::size_t k) const { return points_.maps().at(0, k); }

 private:
  PointMaps points_;
  std::int64_t next_id_ = -2;
};

TEST(Sightings, TwoSightingsNeverShareALandmark) {
  const SightingParameters parameters;
  OneLandmark map(parameters);
  LandmarkDetections d;
  for (const double range : {2.02, 1.9}) {
    d.detections.push_back({.range = range, .covariance = sighting_covariance()});
  }
  const auto fit = map.see(d);
  ASSERT_EQ(map.size(), 1u);  // the second is too near to be new, and the landmark is taken
  EXPECT_EQ(map.at(0).observations, 2);
  EXPECT_EQ(fit.degrees_of_freedom, 2);
  const Matrix2 s = sighting_covariance() + Vector2(1e-4, 1e-4 / 4.0).asDiagonal().toDenseMatrix();
  EXPECT_NEAR(fit.log_likelihood, log_gaussian<2>(Vector2(0.02, 0.0), s) + std::log(parameters.new_density), 1e-9);
}

TEST(Sightings, TheUnassociatedAlwaysPays) {
  const SightingParameters parameters;
  const auto cost_of = [&](double range) {
    OneLandmark map(parameters);
    LandmarkDetections d;
    d.detections.push_back({.range = range, .covariance = sighting_covariance()});
    const auto fit = map.see(d);
    return std::pair{fit.log_likelihood, map.size()};
  };
  const double sd = std::sqrt(0.0101);
  EXPECT_EQ(cost_of(2.0 + 4.0 * sd), (std::pair{std::log(parameters.new_density), std::size_t{1}}));  // dropped
  EXPECT_EQ(cost_of(2.0 + 6.0 * sd), (std::pair{std::log(parameters.new_density), std::size_t{2}}));  // new
}

TEST(Sightings, ImpossibleSightingsCollapseTheWeightsOnceAndAreForgotten) {
  auto filter = filter_with(20);
  Pose2 base;
  Rng rng(5);
  const auto step = [&](int k, bool absurd) {
    base = base * forward().increment;
    auto message = see(base, k, true, 1.0, rng);
    if (absurd) {
      for (auto& d : message.detections) d.range = 1e200;
    }
    filter.predict(forward());
    filter.update(message);
    EXPECT_TRUE(filter.estimate().pose.finite());
    EXPECT_TRUE(filter.estimate().covariance.allFinite());
  };
  for (int k = 0; k < 10; ++k) step(k, false);
  EXPECT_EQ(filter.collapses(), 0);
  step(10, true);
  EXPECT_EQ(filter.collapses(), 1);
  EXPECT_DOUBLE_EQ(filter.estimate().effective_sample_size, 20.0);
  for (int k = 11; k < 25; ++k) step(k, false);
  EXPECT_EQ(filter.collapses(), 1);
  EXPECT_LT(difference(filter.estimate().pose, base).norm(), 0.3);
  for (const auto& l : filter.map().landmarks) {
    EXPECT_LT((l.parameters.head<2>() - kLandmarks[static_cast<std::size_t>(l.id)]).norm(), 0.3);
  }
}

TEST(Sightings, RefusesWhatItCannotUse) {
  Rng rng(6);
  auto filter = filter_with(5);
  filter.update(see({}, 0, true, 0.0, rng));
  const auto expect_refused = [&](auto change) {
    auto message = see({}, 1, true, 0.0, rng);
    change(message);
    EXPECT_THROW(filter.update(message), InputError);
  };
  const double nan = std::nan("");
  expect_refused([](auto& m) {
    m.detections[1].kind = DetectionKind::bearing_only;
    m.detections[1].covariance(1, 1) = 0.0;
  });
  expect_refused([&](auto& m) {
    m.detections[1].kind = DetectionKind::range_only;
    m.detections[1].range = nan;
  });
  expect_refused([&](auto& m) { m.detections[1].range = nan; });
  expect_refused([](auto& m) { m.detections[1].range = -2.0; });
  expect_refused([&](auto& m) { m.detections[1].bearing = nan; });
  expect_refused([](auto& m) { m.detections[1].covariance.setZero(); });
  expect_refused([&](auto& m) { m.detections[1].covariance(0, 1) = nan; });
  expect_refused([](auto& m) { m.detections[1].id = -7; });
  expect_refused([&](auto& m) { m.sensor_in_base.x = nan; });
  expect_refused([](auto& m) { m.stamp.seq = 0; });
  filter.update(see({}, 1, true, 0.0, rng));
}

}  // namespace
}  // namespace noctule::filters
