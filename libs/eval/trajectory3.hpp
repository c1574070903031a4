#pragma once
/// Errors of trajectories in space. A trajectory in the plane is one of them, with z = 0 and a turn about z.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/pose2.hpp"
#include "eval/segments.hpp"
#include "eval/trajectory.hpp"

namespace noctule::eval {

/// Pose of a frame B in a frame A: position [m] and unit quaternion.
struct Pose3 {
  Vector3 position = Vector3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};
[[nodiscard]] Pose3 operator*(const Pose3& a, const Pose3& b);
/// inverse(a) * b.
[[nodiscard]] Pose3 between(const Pose3& a, const Pose3& b);
[[nodiscard]] Pose3 in_space(const Pose2&);
/// x, y, and the yaw of the Euler angles yaw-pitch-roll (z, y', x'').
[[nodiscard]] Pose2 in_plane(const Pose3&);

/// A pose at a time; trajectories are sequences of strictly increasing `utime`.
struct TimedPose3 {
  std::int64_t utime = 0;  ///< microseconds
  Pose3 pose;
};
/// What was estimated and what was true at one time.
struct PosePair3 {
  std::int64_t utime = 0;
  Pose3 estimate;
  Pose3 truth;
};

/// Pairs each pose of the shorter trajectory with the nearest in time of the other one (the earlier of two equally near
/// ones), where they are at most `max_difference` [s] apart. This is what evo does.
[[nodiscard]] std::vector<PosePair3> associate_nearest(std::span<const TimedPose3> estimate,
                                                       std::span<const TimedPose3> truth, double max_difference = 0.01);

/// Pairs each estimate with the truth interpolated at its time (linear, slerp); estimates without truth on both sides,
/// or where these are more than `max_gap` [s] apart, are left out.
[[nodiscard]] std::vector<PosePair3> associate_interpolated(std::span<const TimedPose3> estimate,
                                                            std::span<const TimedPose3> truth,
                                                            double max_gap = std::numeric_limits<double>::infinity());

enum class Alignment3 {
  none,
  yaw,        ///< translation and a turn about z: all that is free where gravity is known
  rigid,      ///< SE(3)
  similarity  ///< SE(3) and one scale
};

/// x -> scale * rotation x + translation
struct Similarity3 {
  double scale = 1.0;
  Matrix3 rotation = Matrix3::Identity();
  Vector3 translation = Vector3::Zero();
  [[nodiscard]] Vector3 operator*(const Vector3& p) const { return scale * (rotation * p) + translation; }
  /// The position as above, the rotation turned along.
  [[nodiscard]] Pose3 operator*(const Pose3& p) const;
};

/// Least-squares alignment of `source` to `target`, point by point (Umeyama 1991). Where the points do not determine
/// the rotation (fewer than three, or all on a line), one of the best is returned; no points: the identity.
/// \throws std::invalid_argument for spans of different length
[[nodiscard]] Similarity3 align(std::span<const Vector3> source, std::span<const Vector3> target, Alignment3);
/// Of the estimated to the true positions.
[[nodiscard]] Similarity3 align(std::span<const PosePair3> pairs, Alignment3);
/// The pairs with their estimates moved.
[[nodiscard]] std::vector<PosePair3> aligned(std::span<const PosePair3> pairs, const Similarity3&);

/// Errors of pairs or segments, in their order.
struct PoseErrorSeries {
  std::vector<double> translation;  ///< [m]
  std::vector<double> rotation;     ///< [rad] angle, >= 0
};
/// Distance and angle between estimate and truth (APE; its translation RMSE is the ATE).
[[nodiscard]] PoseErrorSeries absolute_errors(std::span<const PosePair3> pairs);
/// Relative pose error E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) over segments: Q true, P estimated; needs no alignment (RPE).
[[nodiscard]] PoseErrorSeries relative_errors(std::span<const PosePair3> pairs, std::span<const Segment> segments);

/// True way driven up to each pair [m].
[[nodiscard]] std::vector<double> travelled(std::span<const PosePair3> pairs);

/// Drift as in the KITTI odometry benchmark (Geiger, Lenz and Urtasun 2012): the mean over segments of several lengths
/// of their relative errors, divided by the length. NaN: no segment.
struct Drift {
  int segments = 0;
  double translation = 0.0;  ///< [1] metres per metre
  double rotation = 0.0;     ///< [rad/m]
};
/// \param lengths [m]; KITTI: 100, 200, ... 800 \param every a segment of each length begins at every so many poses;
///        KITTI: 10 \throws std::invalid_argument for `every` 0 or a length that is not positive
[[nodiscard]] Drift drift(std::span<const PosePair3> pairs, std::span<const double> lengths, std::size_t every = 1);

}  // namespace noctule::eval
