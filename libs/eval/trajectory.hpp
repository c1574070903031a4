#pragma once
/// Errors of estimated trajectories and maps of landmarks against the truth.
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/chi2.hpp"
#include "core/estimate.hpp"
#include "core/source.hpp"
#include "eval/metrics.hpp"
#include "eval/segments.hpp"

namespace noctule::eval {

/// A pose of the base in the map frame at a time; trajectories are sequences of strictly increasing `utime`.
struct TimedPose {
  std::int64_t utime = 0;  ///< microseconds
  Pose2 pose;
  friend bool operator==(const TimedPose&, const TimedPose&) = default;
};

/// What was estimated and what was true at one time.
struct PosePair {
  std::int64_t utime = 0;
  Pose2 estimate;
  Pose2 truth;
};

/// Pose at `utime` between two poses of the trajectory: position linear, heading along the shorter way. Nothing outside
/// the trajectory, or where the poses on both sides are more than `max_gap` [s] apart.
[[nodiscard]] std::optional<Pose2> interpolate(std::span<const TimedPose> trajectory, std::int64_t utime,
                                               double max_gap = std::numeric_limits<double>::infinity());

/// Pairs each estimate with the truth interpolated at its time; estimates without truth are left out.
[[nodiscard]] std::vector<PosePair> associate(std::span<const TimedPose> estimate, std::span<const TimedPose> truth,
                                              double max_gap = std::numeric_limits<double>::infinity());

/// Root mean squares, means and maxima; NaN for no pairs.
struct PoseErrors {
  int samples = 0;
  double position_rmse = 0.0;  ///< [m]
  double position_mean = 0.0;  ///< of the distances [m]
  double position_max = 0.0;   ///< [m]
  double heading_rmse = 0.0;   ///< [rad]
  double heading_max = 0.0;    ///< [rad]
};
[[nodiscard]] PoseErrors pose_errors(std::span<const PosePair> pairs);

/// x -> scale * R(rotation) x + translation
struct Similarity2 {
  double scale = 1.0;
  double rotation = 0.0;  ///< [rad]
  Vector2 translation = Vector2::Zero();
  [[nodiscard]] Vector2 operator*(const Vector2& p) const;
};

enum class Alignment {
  none,
  rigid,      ///< SE(2)
  similarity  ///< SE(2) and one scale
};

/// Least-squares alignment of `source` to `target`, point by point (Umeyama 1991). With fewer than two different points
/// only the translation is estimated; with Alignment::none the identity is returned.
/// \throws std::invalid_argument for spans of different length
[[nodiscard]] Similarity2 align(std::span<const Vector2> source, std::span<const Vector2> target, Alignment);

/// Absolute trajectory error: RMS distance [m] of the positions after aligning the estimate to the truth. NaN: no
/// pairs.
[[nodiscard]] double absolute_trajectory_error(std::span<const PosePair> pairs, Alignment);

/// Position errors [m] and heading errors [rad, in [-pi, pi)], in the order of the pairs: the curves over time.
[[nodiscard]] std::vector<double> position_errors(std::span<const PosePair> pairs);
[[nodiscard]] std::vector<double> heading_errors(std::span<const PosePair> pairs);

/// True way driven up to each pair [m].
[[nodiscard]] std::vector<double> travelled(std::span<const PosePair> pairs);
/// segments_by_distance() from every pose on.
[[nodiscard]] std::vector<Segment> segments_by_length(std::span<const PosePair> pairs, double length);

/// Relative pose error E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) over segments: Q true, P estimated; needs no alignment.
struct RelativePoseErrors {
  int segments = 0;
  double translation_rmse = 0.0;  ///< [m]; NaN: no segment
  double rotation_rmse = 0.0;     ///< [rad]
};
[[nodiscard]] RelativePoseErrors relative_pose_errors(std::span<const PosePair> pairs,
                                                      std::span<const Segment> segments);
/// `rpe_translation` and `rpe_rotation`: the same over all segments of `length` [m] of the true way.
[[nodiscard]] std::vector<Metric> relative_pose_metrics(std::span<const PosePair> pairs, double length);

/// Normalised estimation error squared of (x, y, yaw). NaN where the covariance is not positive definite: a filter that
/// starts from a certain pose has none yet.
[[nodiscard]] double nees(const Pose2& estimate, const Matrix3& covariance, const Pose2& truth);

/// A NEES series and the bounds that it should keep. Where a filter has just begun from a certain pose, its covariance
/// is hardly a covariance and single values may be huge: the median says what the mean then does not. Times of one run
/// are dependent: the fraction is a description, the test of consistency is the average over independent runs
/// (noctule::nees_bounds).
struct NeesSummary {
  int samples = 0;                 ///< values that are finite
  double mean = 0.0;               ///< NaN: none
  double median = 0.0;             ///< NaN: none
  Interval step_bounds{0.0, 0.0};  ///< two-sided chi-square interval of a single value
  double inside = 0.0;             ///< fraction of the values within step_bounds; NaN: none
};
[[nodiscard]] NeesSummary nees_summary(std::span<const double> values, int dimension = 3, double probability = 0.95);

/// Index from which on no value lies within the bounds any more: one past the last that does, values.size() when that
/// is the last of all, 0 when none does. A value that is not a number lies outside.
[[nodiscard]] std::size_t leaves_for_good(std::span<const double> values, Interval bounds);

struct LandmarkErrorParameters {
  double gate = 1.0;                      ///< [m] farther pairs are no pairs, where identities are unknown
  bool known_ids = true;                  ///< pair by id; else by the Hungarian method
  Alignment alignment = Alignment::none;  ///< of the estimated to the known landmarks before the errors are taken
};
struct LandmarkErrors {
  int found = 0;
  int missed = 0;
  int invented = 0;
  double rmse = 0.0;  ///< [m]; NaN: none found
  double mean = 0.0;  ///< [m]; NaN: none found
  double max = 0.0;   ///< [m]; NaN: none found
};
/// Errors of the positions of point landmarks (others are ignored).
[[nodiscard]] LandmarkErrors landmark_errors(const LandmarkMap&, std::span<const KnownLandmark>,
                                             const LandmarkErrorParameters& = {});

}  // namespace noctule::eval
