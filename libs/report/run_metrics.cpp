#include <cmath>
#include <limits>

#include "report/pose_series.hpp"
#include "report/results.hpp"

namespace noctule::report {
namespace {

constexpr double kSegmentLength = 1.0;  // [m] of the relative pose error
constexpr double kFixGap = 2.0;         // [s] poses farther apart say nothing about a fix between them

class MetricList {
 public:
  explicit MetricList(std::vector<eval::Metric>& metrics) : metrics_(metrics) {}
  void add(const std::string& name, double value, const char* unit) { metrics_.push_back({name, value, unit}); }
  void add(const std::optional<ContourResult>& contours, const char* suffix) {
    if (!contours || !contours->errors) return;
    for (eval::Metric& m : eval::contour_metrics(*contours->errors, suffix)) metrics_.push_back(std::move(m));
  }

 private:
  std::vector<eval::Metric>& metrics_;
};

void add_trajectory(const std::vector<eval::PosePair>& pairs, const std::string& suffix, MetricList& metrics) {
  if (pairs.empty()) return;
  const eval::PoseErrors errors = eval::pose_errors(pairs);
  metrics.add("position_rmse" + suffix, errors.position_rmse, "m");
  metrics.add("position_max" + suffix, errors.position_max, "m");
  metrics.add("heading_rmse" + suffix, errors.heading_rmse, "rad");
  metrics.add("heading_max" + suffix, errors.heading_max, "rad");
  metrics.add("ate_rmse" + suffix, eval::absolute_trajectory_error(pairs, eval::Alignment::rigid), "m");
  const auto segments = eval::segments_by_length(pairs, kSegmentLength);
  if (segments.empty()) return;
  const eval::RelativePoseErrors relative = eval::relative_pose_errors(pairs, segments);
  metrics.add("rpe_translation_rmse" + suffix, relative.translation_rmse, "m");
  metrics.add("rpe_rotation_rmse" + suffix, relative.rotation_rmse, "rad");
}

/// Position fixes know no heading and lie in a frame of their own: only what is left after alignment counts.
void add_fixes(const std::vector<eval::TimedPose>& trajectory, const std::vector<KnownPosition>& fixes,
               const std::string& suffix, MetricList& metrics) {
  std::vector<eval::PosePair> pairs;
  for (const KnownPosition& fix : fixes) {
    const auto pose = eval::interpolate(trajectory, fix.utime, kFixGap);
    if (pose) pairs.push_back({fix.utime, *pose, {fix.position.x(), fix.position.y(), pose->yaw}});
  }
  if (!pairs.empty()) {
    metrics.add("fix_rmse" + suffix, eval::absolute_trajectory_error(pairs, eval::Alignment::rigid), "m");
  }
}

void add_consistency(const RunData& data, MetricList& metrics) {
  if (!data.truth.empty()) {
    const eval::NeesSummary summary = eval::nees_summary(nees_series(data));
    metrics.add("nees_mean", summary.mean, "1");
    metrics.add("nees_median", summary.median, "1");
    metrics.add("nees_inside", summary.inside, "1");
  }
  double nis = 0.0, size = 0.0;
  int scans = 0;
  for (const SlamEstimate& e : data.estimates) {
    size += e.effective_sample_size;
    if (!(e.nis > 0.0)) continue;  // 0: the observation held nothing to update with
    nis += e.nis;
    ++scans;
  }
  if (data.estimates.empty()) return;
  metrics.add("nis_mean", scans > 0 ? nis / scans : std::numeric_limits<double>::quiet_NaN(), "1");
  metrics.add("effective_sample_size_mean", size / static_cast<double>(data.estimates.size()), "1");
}

void add_landmarks(const RunData& data, MetricList& metrics) {
  if (data.world.landmarks.empty()) return;
  const eval::LandmarkErrors errors =
      eval::landmark_errors(data.landmarks, data.world.landmarks, {.known_ids = data.landmark_ids_known});
  metrics.add("landmark_rmse", errors.rmse, "m");
  metrics.add("landmarks_found", errors.found, "1");
  metrics.add("landmarks_missed", errors.missed, "1");
  metrics.add("landmarks_invented", errors.invented, "1");
}

double length(const std::vector<eval::TimedPose>& trajectory) {
  double sum = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    sum += (trajectory[i].pose.position() - trajectory[i - 1].pose.position()).norm();
  }
  return sum;
}

}  // namespace

std::vector<eval::TimedPose> filter_trajectory(const RunData& data) {
  std::vector<eval::TimedPose> trajectory;
  trajectory.reserve(data.estimates.size());
  for (const SlamEstimate& e : data.estimates) trajectory.push_back({e.stamp.utime, e.pose});
  return trajectory;
}

std::vector<double> nees_series(const RunData& data) {
  std::vector<double> series;
  series.reserve(data.estimates.size());
  for (const SlamEstimate& e : data.estimates) {
    const auto truth = eval::interpolate(data.truth, e.stamp.utime);
    series.push_back(truth ? eval::nees(e.pose, e.covariance, *truth) : std::numeric_limits<double>::quiet_NaN());
  }
  return series;
}

std::vector<eval::Metric> run_metrics(const RunData& data) {
  std::vector<eval::Metric> result;
  MetricList metrics(result);
  metrics.add(data.contours, "");
  metrics.add(data.contours_known_pose, "_known_pose");
  metrics.add(data.contours_dead_reckoning, "_dead_reckoning");
  const std::vector<eval::TimedPose> filtered = filter_trajectory(data);
  add_trajectory(eval::associate(filtered, data.truth), "", metrics);
  add_trajectory(eval::associate(data.dead_reckoning, data.truth), "_dead_reckoning", metrics);
  add_fixes(filtered, data.world.fixes, "", metrics);
  add_fixes(data.dead_reckoning, data.world.fixes, "_dead_reckoning", metrics);
  add_landmarks(data, metrics);
  add_consistency(data, metrics);
  metrics.add("path_length", length(data.truth.empty() ? filtered : data.truth), "m");
  return result;
}

}  // namespace noctule::report
