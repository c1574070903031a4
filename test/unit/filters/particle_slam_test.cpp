#include "filters/slam/particle_slam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/error.hpp"
#include "core/limits.hpp"
#include "unit/filters/recording.hpp"

namespace noctule::filters {
namespace {

using test::arc_path;
using test::corner_scene;
using test::Drive;
using test::noisy_drive;
using test::play;
using test::record;
using test::Scene;
using test::with_particles;

const LandmarkEstimate* find(const LandmarkMap& map, LandmarkKind kind, const Vector3& near, double tolerance) {
  for (const auto& l : map.landmarks) {
    Vector3 d = l.parameters - near;
    if (kind == LandmarkKind::wall) d[1] = wrap(d[1]);
    if (l.kind == kind && d.cwiseAbs().maxCoeff() < tolerance) return &l;
  }
  return nullptr;
}

TEST(ParticleSlam, OneParticleWithoutNoiseIsExact) {
  Drive drive;
  drive.ranger.exact = true;
  const auto path = arc_path(12, 0.1, 0.05);
  ParticleSlam filter(with_particles(1), 1);
  play(record(corner_scene(), path, drive, 1), filter);

  EXPECT_LT(difference(filter.estimate().pose, path.back()).norm(), 1e-12);
  EXPECT_EQ(filter.estimate().effective_sample_size, 1.0);
  EXPECT_NEAR(filter.estimate().nis, 0.0, 1e-12);
  const auto poses = filter.path().poses;
  ASSERT_EQ(poses.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(poses[i].scan_seq, static_cast<std::int64_t>(i));
    EXPECT_LT(difference(poses[i].pose, path[i]).norm(), 1e-12);
  }
  const auto map = filter.map();
  EXPECT_EQ(map.landmarks.size(), 3u);
  EXPECT_NE(find(map, LandmarkKind::wall, {1.5, 0.3, 0.0}, 1e-9), nullptr);
  EXPECT_NE(find(map, LandmarkKind::wall, {2.0, 0.3 + kPi / 2, 0.0}, 1e-9), nullptr);
  // The radius starts at 8 cm, for the extractor does not claim to know it: it is learned from the ranges.
  EXPECT_NE(find(map, LandmarkKind::cylinder, {1.0, -1.3, 0.12}, 0.02), nullptr);
}

TEST(ParticleSlam, WrongInitialValuesAreForgotten) {
  Drive drive;
  drive.ranger.exact = true;
  drive.errors = {.range = 0.03, .direction = radians(5.0)};
  ParticleSlam filter(with_particles(1), 1);
  play(record(corner_scene(), arc_path(40, 0.08, 0.1), drive, 3), filter);
  EXPECT_NE(find(filter.map(), LandmarkKind::wall, {1.5, 0.3, 0.0}, 1e-3), nullptr);
  EXPECT_NE(find(filter.map(), LandmarkKind::wall, {2.0, 0.3 + kPi / 2, 0.0}, 1e-3), nullptr);
  EXPECT_NE(find(filter.map(), LandmarkKind::cylinder, {1.0, -1.3, 0.12}, 5e-3), nullptr);
}

TEST(ParticleSlam, OpenTypesAreDecidedByTheEchoes) {
  // Once round a cylinder and a rod, with two walls outside.
  Drive drive;
  drive.errors.undecided = true;
  Scene scene = corner_scene();
  scene.cylinders = {{Vector2(0.2, 0.9), 0.12}, {Vector2(-0.25, 0.6), 0.0}};
  ParticleSlam filter(with_particles(1), 1);
  play(record(scene, arc_path(64, 0.08, 0.1), drive, 5), filter);
  const auto map = filter.map();
  EXPECT_EQ(map.landmarks.size(), 4u);
  EXPECT_NE(find(map, LandmarkKind::wall, {1.5, 0.3, 0.0}, 0.01), nullptr);
  EXPECT_NE(find(map, LandmarkKind::wall, {2.0, 0.3 + kPi / 2, 0.0}, 0.01), nullptr);
  EXPECT_NE(find(map, LandmarkKind::cylinder, {0.2, 0.9, 0.12}, 0.01), nullptr);
  EXPECT_NE(find(map, LandmarkKind::point, {-0.25, 0.6, 0.0}, 0.01), nullptr);
}

TEST(ParticleSlam, OverlappingFeaturesStartALandmarkOnce) {
  const Pose2 base;
  Rng rng(7);
  const auto heard = test::listen(corner_scene(), base, 0, {}, rng);
  auto features = test::extract(corner_scene(), base, heard, {}, {}, rng);
  const auto once = features.features;
  features.features.insert(features.features.end(), once.begin(), once.end());
  ParticleSlam filter(with_particles(3), 1);
  filter.update(heard.scan, features);
  EXPECT_EQ(filter.map().landmarks.size(), once.size());
  int observations = 0, echoes = 0;
  for (const auto& l : filter.map().landmarks) observations += l.observations;
  for (const auto& beams : heard.beams_of) echoes += static_cast<int>(beams.size());
  EXPECT_LE(observations, echoes);
}

TEST(ParticleSlam, MuchNoiseStartsNoSecondLandmarkBesideTheFirst) {
  // Four times the noise the filter was told: many echoes look like clutter, and features are made of them.
  Drive drive;
  const auto path = arc_path(40, 0.1, 0.15);
  auto r = record(corner_scene(), path, drive, 3);
  drive.ranger.noise = {.base = 0.012, .relative = 0.02};
  drive.errors = {.range = 0.04, .direction = radians(5.0)};
  const auto noisy = record(corner_scene(), path, drive, 4);
  std::copy(noisy.heard.begin() + 15, noisy.heard.end(), r.heard.begin() + 15);
  std::copy(noisy.features.begin() + 15, noisy.features.end(), r.features.begin() + 15);
  const auto landmarks_with = [&](double separation) {
    auto p = with_particles(1);
    p.contour_landmarks.separation = separation;
    ParticleSlam filter(p, 1);
    play(r, filter);
    return filter.map().landmarks.size();
  };
  EXPECT_EQ(landmarks_with(ContourLandmarkParameters{}.separation), 3u);
  EXPECT_GT(landmarks_with(0.0), 3u);
}

TEST(ParticleSlam, LandmarksNeverHeardAgainAreDeleted) {
  Drive drive;
  const auto path = arc_path(12, 0.1, 0.0);
  auto r = record(corner_scene(), path, drive, 2);
  // A phantom in front of the robot, heard at the first stop only.
  ContourFeature phantom;
  phantom.type = ContourType::point;
  phantom.surface = {0.5, 0.0};
  phantom.readings.push_back({0, static_cast<std::int32_t>(r.heard[0].scan.beams.size())});
  r.heard[0].scan.beams.push_back({Pose2{}, 0.5, Echo::hit});
  r.features[0].features.push_back(phantom);
  ParticleSlam filter(with_particles(1), 1);
  const auto has_phantom = [&] { return find(filter.map(), LandmarkKind::point, {0.5, 0.0, 0.0}, 0.05) != nullptr; };
  for (std::size_t i = 0; i < path.size(); ++i) {
    filter.predict(r.odometry[i]);
    filter.update(r.heard[i].scan, r.features[i]);
    EXPECT_EQ(has_phantom(), i < 6) << "stop " << i;
  }
  EXPECT_EQ(filter.map().landmarks.size(), 3u);
}

TEST(ParticleSlam, WorksWithoutFeaturesAndWithStaleOnes) {
  const auto path = arc_path(10, 0.1, 0.05);
  const auto r = record(corner_scene(), path, noisy_drive(), 4);
  ParticleSlam filter(with_particles(50), 1);
  for (std::size_t i = 0; i < path.size(); ++i) {
    filter.predict(r.odometry[i]);
    filter.update(r.heard[i].scan, i > 0 ? r.features[i - 1] : ContourFeatures{});
  }
  EXPECT_TRUE(filter.map().landmarks.empty());
  EXPECT_EQ(filter.path().poses.size(), path.size());
  EXPECT_FALSE(filter.estimate().resampled);  // all echoes are clutter to all particles
  EXPECT_LT(difference(filter.estimate().pose, path.back()).norm(), 0.3);
}

TEST(ParticleSlam, EqualBitsForAnyThreadsAndOnRepeat) {
  const auto r = record(corner_scene(), arc_path(25, 0.1, 0.1), noisy_drive(), 6);
  const auto run = [&](int threads, std::uint64_t seed) {
    auto p = with_particles(150);
    p.threads = threads;
    ParticleSlam filter(p, seed);
    play(r, filter);
    std::vector<double> numbers;
    const auto note = [&](const Pose2& q) { numbers.insert(numbers.end(), {q.x, q.y, q.yaw}); };
    const SlamEstimate estimate = filter.estimate();
    note(estimate.pose);
    numbers.insert(numbers.end(), estimate.covariance.data(), estimate.covariance.data() + 9);
    numbers.insert(numbers.end(), {estimate.nis, estimate.effective_sample_size});
    for (const auto& q : filter.path().poses) note(q.pose);
    for (const auto& q : filter.particles(1000).particles) note(q.pose);
    for (const auto& l : filter.map().landmarks) {
      numbers.insert(numbers.end(), l.parameters.data(), l.parameters.data() + 3);
      numbers.insert(numbers.end(), l.covariance.data(), l.covariance.data() + 9);
    }
    return numbers;
  };
  const auto reference = run(1, 11);
  EXPECT_EQ(run(1, 11), reference);
  EXPECT_EQ(run(2, 11), reference);
  EXPECT_NE(run(1, 12), reference);
}

/// After many resamplings the best particle's map must be the one its own path leads to, and no other's.
TEST(ParticleSlam, MapBelongsToThePathThroughAllResamplings) {
  const auto r = record(corner_scene(), arc_path(30, 0.1, 0.1), noisy_drive(), 8);
  ParticleSlam filter(with_particles(60), 3);
  int resamplings = 0;
  for (std::size_t i = 0; i < r.heard.size(); ++i) {
    filter.predict(r.odometry[i]);
    filter.update(r.heard[i].scan, r.features[i]);
    resamplings += filter.estimate().resampled;
    if (filter.estimate().resampled) {
      EXPECT_LT(filter.estimate().distinct_particles, 60);
    }
  }
  EXPECT_GT(resamplings, 3);
  EXPECT_LT(filter.estimate().distinct_ancestors, 60);
  const auto path = filter.path().poses;
  ASSERT_EQ(path.size(), r.heard.size());
  const auto cloud = filter.particles(60).particles;
  EXPECT_TRUE(std::ranges::any_of(cloud, [&](const auto& p) { return p.pose == path.back().pose; }));

  ParticleSlam alone(with_particles(1), 1);
  for (std::size_t i = 0; i < path.size(); ++i) {
    Odometry o;
    o.increment = i == 0 ? path[0].pose : between(path[i - 1].pose, path[i].pose);
    alone.predict(o);
    alone.update(r.heard[i].scan, r.features[i]);
  }
  const auto map = filter.map().landmarks, again = alone.map().landmarks;
  ASSERT_EQ(map.size(), again.size());
  for (std::size_t k = 0; k < map.size(); ++k) {
    EXPECT_EQ(map[k].id, again[k].id);
    EXPECT_EQ(map[k].observations, again[k].observations);
    EXPECT_TRUE(map[k].parameters.isApprox(again[k].parameters, 1e-9));
    EXPECT_TRUE(map[k].covariance.isApprox(again[k].covariance, 1e-6));
  }
}

TEST(ParticleSlam, TakesEveryResamplingMethod) {
  const auto path = arc_path(30, 0.1, 0.1);
  const auto r = record(corner_scene(), path, noisy_drive(), 8);
  for (const auto& [name, method] : particle::resampling_choices()) {
    auto p = with_particles(60);
    p.resampling = method;
    ParticleSlam filter(p, 3);
    int resamplings = 0;
    for (std::size_t i = 0; i < r.heard.size(); ++i) {
      filter.predict(r.odometry[i]);
      filter.update(r.heard[i].scan, r.features[i]);
      resamplings += filter.estimate().resampled;
    }
    EXPECT_GT(resamplings, 3) << name;
    EXPECT_LT((filter.estimate().pose.position() - path.back().position()).norm(), 0.15) << name;
  }
}

TEST(ParticleSlam, ZeroMotionMovesNothing) {
  ParticleSlam filter(with_particles(20), 1, {1.0, 2.0, 3.0});
  Rng rng(1);
  for (int k = 0; k < 3; ++k) {
    filter.predict({});
    filter.update(test::listen(corner_scene(), {}, k, {}, rng).scan, {});
    for (const auto& p : filter.particles(20).particles) EXPECT_EQ(p.pose, (Pose2{1.0, 2.0, 3.0}));
  }
}

TEST(ParticleSlam, OdometryBetweenTwoScansIsSummedUp) {
  // One step of 0.2 m with its covariance and the same in two halves sample the same cloud.
  Odometry whole;
  whole.increment = {0.2, 0.0, 0.0};
  whole.covariance.diagonal() << 2e-4, 0.0, 0.0;
  Odometry half;
  half.increment = {0.1, 0.0, 0.0};
  half.covariance.diagonal() << 1e-4, 0.0, 0.0;
  ParticleSlam a(with_particles(10), 5), b(with_particles(10), 5);
  UltrasonicScan silence;
  silence.half_angle = 0.2;
  a.predict(whole);
  a.update(silence, {});
  b.predict(half);
  b.predict(half);
  b.update(silence, {});
  const auto pa = a.particles(10).particles, pb = b.particles(10).particles;
  for (std::size_t i = 0; i < 10; ++i) EXPECT_LT(difference(pa[i].pose, pb[i].pose).norm(), 1e-12);
  EXPECT_GT(a.estimate().covariance(0, 0), 0.0);
  EXPECT_EQ(a.estimate().covariance(1, 1), 0.0);
}

TEST(ParticleSlam, DrawsACloudOfTheAskedSize) {
  const auto r = record(corner_scene(), arc_path(6, 0.1, 0.1), noisy_drive(), 8);
  ParticleSlam filter(with_particles(40), 3);
  play(r, filter);
  for (const int size : {0, 1, 7, 40, 100}) {
    const auto cloud = filter.particles(size);
    EXPECT_EQ(std::ssize(cloud.particles), std::min(size, 40));
    double sum = 0.0;
    for (const auto& p : cloud.particles) sum += p.weight;
    if (size > 0) {
      EXPECT_NEAR(sum, 1.0, 1e-12);
    }
  }
}

TEST(ParticleSlam, RefusesWhatIsNotFiniteAndStaysAsItWas) {
  const auto r = record(corner_scene(), arc_path(3, 0.1, 0.1), noisy_drive(), 8);
  ParticleSlam filter(with_particles(10), 3), untouched(with_particles(10), 3);
  play(r, filter);
  play(r, untouched);

  Odometry o;
  o.increment.yaw = kNan;
  EXPECT_THROW(filter.predict(o), InputError);
  o = {};
  o.covariance(1, 1) = -1.0;
  EXPECT_THROW(filter.predict(o), InputError);
  o.covariance(1, 1) = kNan;
  EXPECT_THROW(filter.predict(o), InputError);

  auto next = r.heard[2];
  next.scan.stamp.seq = 3;
  const auto expect_refused = [&](auto change) {
    auto scan = next.scan;
    change(scan);
    EXPECT_THROW(filter.update(scan, {}), InputError);
  };
  next.scan.beams[5] = {Pose2{}, 1.0, Echo::hit};
  expect_refused([](auto& s) { s.beams[5].range = kNan; });
  expect_refused([](auto& s) { s.beams[5].range = -1.0; });
  expect_refused([](auto& s) { s.beams[5].range = std::numeric_limits<double>::infinity(); });
  expect_refused([](auto& s) { s.beams[0].sensor_in_base.yaw = kNan; });
  expect_refused([](auto& s) { s.half_angle = 0.0; });
  expect_refused([](auto& s) { s.stamp.seq = 2; });  // the same scan again
  ContourFeatures features{next.scan.stamp, {ContourFeature{}}};
  features.features[0].wall.rho = kNan;
  EXPECT_THROW(filter.update(next.scan, features), InputError);
  features.features[0].wall.rho = 1.0;
  features.features[0].readings = {{3, 60}};
  EXPECT_THROW(filter.update(next.scan, features), InputError);
  try {
    auto scan = next.scan;
    scan.beams[5].range = kNan;
    filter.update(scan, {});
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "ultrasonic scan 3, beam 5: range of a hit: expected metres > 0, got nan");
  }

  filter.update(next.scan, {});
  untouched.update(next.scan, {});
  EXPECT_EQ(filter.estimate().pose, untouched.estimate().pose);
  EXPECT_EQ(filter.estimate().covariance, untouched.estimate().covariance);
}

TEST(ParticleSlam, RefusesImpossibleParameters) {
  EXPECT_THROW(ParticleSlam(with_particles(0), 1), InputError);
  auto p = with_particles(10);
  p.echo.range_noise.base = 0.0;
  EXPECT_THROW(ParticleSlam(p, 1), InputError);
  p = with_particles(10);
  p.sightings.new_above = 1.0;
  EXPECT_THROW(ParticleSlam(p, 1), InputError);
  EXPECT_THROW(ParticleSlam(with_particles(10), 1, {kNan, 0.0, 0.0}), InputError);
}

}  // namespace
}  // namespace noctule::filters
