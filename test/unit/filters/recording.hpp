#pragma once
/// Recorded runs through a test scene, and how to play them to a filter.
#include <algorithm>
#include <vector>

#include "core/gaussian.hpp"
#include "filters/slam/particle_slam.hpp"
#include "unit/filters/scene.hpp"

namespace noctule::test {

/// What a robot on `path` reports, with the given noise of its odometry.
struct Recording {
  std::vector<Odometry> odometry;  ///< before each scan
  std::vector<Heard> heard;
  std::vector<ContourFeatures> features;
};

struct Drive {
  Matrix3 odometry_covariance = Matrix3::Zero();
  Ranger ranger;
  ExtractorErrors errors;
};

inline Recording record(const Scene& scene, const std::vector<Pose2>& path, const Drive& drive, std::uint64_t seed) {
  Recording r;
  Rng rng(seed, stream_id("test.scene"));
  const Matrix3 root = square_root<3>(drive.odometry_covariance);
  for (std::size_t i = 0; i < path.size(); ++i) {
    Odometry o;
    o.stamp = {static_cast<std::int64_t>(i) * 1000000, static_cast<std::int64_t>(i)};
    if (i > 0) {
      const Vector3 error = sample_gaussian<3>(root, rng);
      const Pose2 step = between(path[i - 1], path[i]);
      o.increment = {step.x + error[0], step.y + error[1], step.yaw + error[2]};
      o.covariance = drive.odometry_covariance;
    }
    r.odometry.push_back(o);
    r.heard.push_back(listen(scene, path[i], static_cast<std::int64_t>(i), drive.ranger, rng));
    const std::vector<Heard> earlier(r.heard.end() - std::min<std::ptrdiff_t>(3, std::ssize(r.heard)),
                                     r.heard.end() - 1);
    r.features.push_back(extract(scene, path[i], r.heard.back(), earlier, drive.errors, rng));
  }
  return r;
}

inline void play(const Recording& r, filters::ParticleSlam& filter) {
  for (std::size_t i = 0; i < r.heard.size(); ++i) {
    filter.predict(r.odometry[i]);
    filter.update(r.heard[i].scan, r.features[i]);
  }
}

inline filters::ParticleSlamParameters with_particles(int n) {
  filters::ParticleSlamParameters p;
  p.particles = n;
  return p;
}

inline Drive noisy_drive() {
  Drive drive;
  drive.odometry_covariance.diagonal() << 1e-4, 2.5e-5, 2e-4;
  drive.errors = {.range = 0.01, .direction = radians(2.0)};
  return drive;
}

}  // namespace noctule::test
