#pragma once
/// What a SLAM filter says.
#include <cstdint>
#include <vector>

#include "core/contour.hpp"
#include "core/pose2.hpp"
#include "core/stamp.hpp"

namespace noctule {

struct SlamEstimate {
  Stamp stamp;                           ///< of the observation it includes
  Pose2 pose;                            ///< base_link in map, weighted mean (circular in yaw), before resampling
  Matrix3 covariance = Matrix3::Zero();  ///< weighted sample covariance, order (x, y, yaw)
  int particles = 0;
  double effective_sample_size = 0.0;  ///< 1 / sum w^2, in [1, particles]
  int distinct_particles = 0;          ///< survivors of the latest resampling (particles when none yet)
  int distinct_ancestors = 0;          ///< different ancestors among the particles of the first scan
  bool resampled = false;
  double noise_scale = 1.0;  ///< the filter's idea of the noise, in units of the configured sd
  double nis = 0.0;          ///< mean normalised innovation squared of this scan (per degree of freedom)
};

/// The pose of the base at one scan, along the path of one particle.
struct PathPose {
  std::int64_t scan_seq = 0;
  std::int64_t utime = 0;
  Pose2 pose;
};
/// Best particle's whole path; supersedes every earlier one.
struct PathEstimate {
  Stamp stamp;
  std::vector<PathPose> poses;
};

enum class LandmarkKind : std::int8_t { point = 0, wall = 1, cylinder = 2, undecided = 3 };

struct LandmarkEstimate {
  std::int64_t id = 0;
  LandmarkKind kind = LandmarkKind::point;
  Vector3 parameters = Vector3::Zero();  ///< point (x, y, 0), wall (rho, theta, 0), cylinder (x, y, radius)
  Matrix3 covariance = Matrix3::Zero();  ///< same order
  int observations = 0;
};
struct LandmarkMap {
  Stamp stamp;
  std::vector<LandmarkEstimate> landmarks;
};

struct WeightedPose {
  Pose2 pose;
  double weight = 0.0;
};
struct ParticleCloud {
  Stamp stamp;
  std::vector<WeightedPose> particles;
};

}  // namespace noctule
