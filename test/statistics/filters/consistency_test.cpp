/// Does the filter know how well it knows? Chi-square bounds on walls and poses over independent runs, fed with
/// features whose readings overlap from scan to scan. The control: a filter that is given every reading three times, as
/// often as it stands in overlapping triples, must fail.
#include <gtest/gtest.h>

#include "core/chi2.hpp"
#include "unit/filters/recording.hpp"

namespace noctule::filters {
namespace {

using test::Drive;
using test::Recording;

constexpr std::int64_t kCopies = 3;

/// The recording as a wrong front end would send it: each scan under three numbers, as if measured anew.
Recording overcounted(const Recording& r) {
  Recording d;
  for (std::size_t i = 0; i < r.heard.size(); ++i) {
    for (std::int64_t copy = 0; copy < kCopies; ++copy) {
      d.odometry.push_back(copy == 0 ? r.odometry[i] : Odometry{});
      d.heard.push_back(r.heard[i]);
      d.features.push_back(r.features[i]);
      const std::int64_t seq = kCopies * r.heard[i].scan.stamp.seq + copy;
      d.heard.back().scan.stamp.seq = d.features.back().stamp.seq = seq;
      for (auto& f : d.features.back().features) {
        for (auto& reading : f.readings) reading.scan_seq = kCopies * reading.scan_seq + copy;
      }
    }
  }
  return d;
}

ParticleSlamParameters consistent_parameters(int particles) {
  auto p = test::with_particles(particles);
  p.echo.clutter_fraction = 1e-6;  // the scene has none: every echo belongs to a landmark, however far out
  return p;
}

/// Mean NEES (2 numbers) of a wall mapped along a known path.
double wall_nees(int runs, bool overcount) {
  double sum = 0.0;
  const test::Scene scene = test::corner_scene();
  for (int run = 0; run < runs; ++run) {
    Drive drive;
    drive.errors = {.range = 0.02, .direction = radians(4.0)};
    const auto recording =
        test::record(scene, test::arc_path(20, 0.1, 0.1), drive, 1000 + static_cast<std::uint64_t>(run));
    ParticleSlam filter(consistent_parameters(1), 1);
    test::play(overcount ? overcounted(recording) : recording, filter);
    const LandmarkEstimate* wall = nullptr;
    for (const auto map = filter.map(); const auto& l : map.landmarks) {
      if (l.kind != LandmarkKind::wall) continue;
      const Vector2 e(l.parameters[0] - scene.walls[0].rho, wrap(l.parameters[1] - scene.walls[0].theta));
      if (e.norm() > 0.5) continue;
      wall = &l;
      sum += mahalanobis2<2>(e, l.covariance.topLeftCorner<2, 2>());
    }
    EXPECT_NE(wall, nullptr) << "run " << run;
  }
  return sum / runs;
}

TEST(Consistency, WallAlongAKnownPath) {
  constexpr int runs = 200;
  const Interval bounds = nees_bounds(2, runs, 0.999);
  const double once = wall_nees(runs, false);
  EXPECT_GT(once, bounds.low);
  EXPECT_LT(once, bounds.high);
  EXPECT_GT(wall_nees(runs, true), bounds.high);
}

/// Mean NEES (3 numbers) of the pose at the end of a short run in which the room is mapped as well. Short, and with so
/// many particles, that the particles' lack of diversity does not show: that is a matter of every particle filter.
double pose_nees(int runs, bool overcount) {
  double sum = 0.0;
  for (int run = 0; run < runs; ++run) {
    const auto path = test::arc_path(5, 0.1, 0.1);
    const auto recording =
        test::record(test::corner_scene(), path, test::noisy_drive(), 2000 + static_cast<std::uint64_t>(run));
    ParticleSlam filter(consistent_parameters(800), 5);
    test::play(overcount ? overcounted(recording) : recording, filter);
    const auto estimate = filter.estimate();
    sum += mahalanobis2<3>(difference(estimate.pose, path.back()), estimate.covariance);
  }
  return sum / runs;
}

TEST(Consistency, PoseInAnUnknownRoom) {
  constexpr int runs = 50;
  const Interval bounds = nees_bounds(3, runs, 0.999);
  const double once = pose_nees(runs, false);
  EXPECT_GT(once, bounds.low);
  EXPECT_LT(once, bounds.high);
  EXPECT_GT(pose_nees(runs, true), bounds.high);
}

TEST(Consistency, InnovationsHaveTheirVariance) {
  // Directions scatter a little less than the Gaussian says, for the cone cuts its tails: 1 is an upper bound.
  double sum = 0.0;
  int scans = 0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    const auto recording =
        test::record(test::corner_scene(), test::arc_path(15, 0.1, 0.1), test::noisy_drive(), 3000 + run);
    ParticleSlam filter(consistent_parameters(100), 5);
    for (std::size_t i = 0; i < recording.heard.size(); ++i) {
      filter.predict(recording.odometry[i]);
      filter.update(recording.heard[i].scan, recording.features[i]);
      if (i == 0) continue;  // starts the landmarks
      sum += filter.estimate().nis;
      ++scans;
    }
  }
  EXPECT_NEAR(sum / scans, 0.9, 0.15);
}

}  // namespace
}  // namespace noctule::filters
