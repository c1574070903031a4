#include "eval/trajectory.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "core/assignment.hpp"
#include "core/gaussian.hpp"
#include "core/limits.hpp"
#include "eval/statistics.hpp"

namespace noctule::eval {
namespace {

/// Mean, mean square and maximum of a stream of non-negative numbers.
struct Accumulator {
  int samples = 0;
  double sum = 0.0;
  double square = 0.0;
  double max = 0.0;
  void add(double value) {
    ++samples;
    sum += value;
    square += value * value;
    max = std::max(max, value);
  }
  [[nodiscard]] double mean() const { return samples > 0 ? sum / samples : kNan; }
  [[nodiscard]] double rms() const { return samples > 0 ? std::sqrt(square / samples) : kNan; }
  [[nodiscard]] double maximum() const { return samples > 0 ? max : kNan; }
};

}  // namespace

std::optional<Pose2> interpolate(std::span<const TimedPose> trajectory, std::int64_t utime, double max_gap) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), utime,
                                      [](const TimedPose& p, std::int64_t t) { return p.utime < t; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->utime == utime) return after->pose;
  if (after == trajectory.begin()) return std::nullopt;
  const TimedPose& a = *std::prev(after);
  const TimedPose& b = *after;
  if (seconds(b.utime - a.utime) > max_gap) return std::nullopt;
  const double part = static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  return Pose2{std::lerp(a.pose.x, b.pose.x, part), std::lerp(a.pose.y, b.pose.y, part),
               wrap(a.pose.yaw + part * wrap(b.pose.yaw - a.pose.yaw))};
}

std::vector<PosePair> associate(std::span<const TimedPose> estimate, std::span<const TimedPose> truth, double max_gap) {
  std::vector<PosePair> pairs;
  pairs.reserve(estimate.size());
  for (const TimedPose& e : estimate) {
    if (const auto t = interpolate(truth, e.utime, max_gap)) pairs.push_back({e.utime, e.pose, *t});
  }
  return pairs;
}

PoseErrors pose_errors(std::span<const PosePair> pairs) {
  Accumulator position, heading;
  for (const double e : position_errors(pairs)) position.add(e);
  for (const double e : heading_errors(pairs)) heading.add(std::abs(e));
  return {position.samples, position.rms(), position.mean(), position.maximum(), heading.rms(), heading.maximum()};
}

Vector2 Similarity2::operator*(const Vector2& p) const {
  const double c = std::cos(rotation), s = std::sin(rotation);
  return scale * Vector2(c * p.x() - s * p.y(), s * p.x() + c * p.y()) + translation;
}

Similarity2 align(std::span<const Vector2> source, std::span<const Vector2> target, Alignment alignment) {
  if (source.size() != target.size()) throw std::invalid_argument("align: source and target differ in length");
  if (alignment == Alignment::none || source.empty()) return {};
  Vector2 source_mean = Vector2::Zero(), target_mean = Vector2::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    source_mean += source[i];
    target_mean += target[i];
  }
  source_mean /= static_cast<double>(source.size());
  target_mean /= static_cast<double>(source.size());

  // In the plane Umeyama's singular value decomposition is one angle: sums of dot and cross products.
  double dot = 0.0, cross = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Vector2 a = source[i] - source_mean, b = target[i] - target_mean;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
    variance += a.squaredNorm();
  }
  Similarity2 s;
  if (dot != 0.0 || cross != 0.0) {
    s.rotation = std::atan2(cross, dot);
    if (alignment == Alignment::similarity) s.scale = std::hypot(dot, cross) / variance;
  }
  s.translation = target_mean - s * source_mean;
  return s;
}

double absolute_trajectory_error(std::span<const PosePair> pairs, Alignment alignment) {
  std::vector<Vector2> estimate, truth;
  for (const PosePair& p : pairs) {
    estimate.push_back(p.estimate.position());
    truth.push_back(p.truth.position());
  }
  const Similarity2 s = align(estimate, truth, alignment);
  Accumulator error;
  for (std::size_t i = 0; i < pairs.size(); ++i) error.add((s * estimate[i] - truth[i]).norm());
  return error.rms();
}

std::vector<double> position_errors(std::span<const PosePair> pairs) {
  std::vector<double> errors;
  for (const PosePair& p : pairs) errors.push_back((p.estimate.position() - p.truth.position()).norm());
  return errors;
}

std::vector<double> heading_errors(std::span<const PosePair> pairs) {
  std::vector<double> errors;
  for (const PosePair& p : pairs) errors.push_back(wrap(p.estimate.yaw - p.truth.yaw));
  return errors;
}

std::vector<double> travelled(std::span<const PosePair> pairs) {
  std::vector<double> way(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    way[i] = way[i - 1] + (pairs[i].truth.position() - pairs[i - 1].truth.position()).norm();
  }
  return way;
}

std::vector<Segment> segments_by_length(std::span<const PosePair> pairs, double length) {
  return segments_by_distance(travelled(pairs), length, SegmentStarts::every_pose);
}

RelativePoseErrors relative_pose_errors(std::span<const PosePair> pairs, std::span<const Segment> segments) {
  Accumulator translation, rotation;
  for (const auto& [i, j] : segments) {
    const Pose2 truth = between(pairs[i].truth, pairs[j].truth);
    const Pose2 error = between(truth, between(pairs[i].estimate, pairs[j].estimate));
    translation.add(error.position().norm());
    rotation.add(std::abs(error.yaw));
  }
  return {translation.samples, translation.rms(), rotation.rms()};
}

std::vector<Metric> relative_pose_metrics(std::span<const PosePair> pairs, double length) {
  const RelativePoseErrors errors = relative_pose_errors(pairs, segments_by_length(pairs, length));
  return {{"rpe_translation", errors.translation_rmse, "m"}, {"rpe_rotation", errors.rotation_rmse, "rad"}};
}

double nees(const Pose2& estimate, const Matrix3& covariance, const Pose2& truth) {
  const Eigen::LLT<Matrix3> llt(covariance);
  if (llt.info() != Eigen::Success || !covariance.allFinite()) return kNan;
  return llt.matrixL().solve(difference(estimate, truth)).squaredNorm();
}

NeesSummary nees_summary(std::span<const double> values, int dimension, double probability) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  NeesSummary s;
  s.samples = static_cast<int>(finite.size());
  s.step_bounds = nees_bounds(dimension, 1, probability);
  if (finite.empty()) {
    s.mean = s.median = s.inside = kNan;
    return s;
  }
  const auto inside = std::count_if(finite.begin(), finite.end(),
                                    [&](double v) { return v >= s.step_bounds.low && v <= s.step_bounds.high; });
  s.mean = mean(finite);
  s.median = quantile(finite, 0.5);
  s.inside = static_cast<double>(inside) / static_cast<double>(finite.size());
  return s;
}

std::size_t leaves_for_good(std::span<const double> values, Interval bounds) {
  std::size_t end = values.size();
  while (end > 0 && !(values[end - 1] >= bounds.low && values[end - 1] <= bounds.high)) --end;
  return end;
}

namespace {

/// Index into `points` for each known landmark, -1 where none belongs to it.
std::vector<int> associate_landmarks(const std::vector<const LandmarkEstimate*>& points,
                                     std::span<const KnownLandmark> known, const LandmarkErrorParameters& parameters) {
  if (!parameters.known_ids) {
    Eigen::MatrixXd cost(known.size(), points.size());
    for (std::size_t i = 0; i < known.size(); ++i) {
      for (std::size_t j = 0; j < points.size(); ++j) {
        cost(i, j) = (points[j]->parameters.head<2>() - known[i].position).norm();
      }
    }
    return assign(cost, parameters.gate);
  }
  std::vector<int> match;
  for (const KnownLandmark& k : known) {
    const auto it = std::find_if(points.begin(), points.end(), [&](const auto* p) { return p->id == k.id; });
    match.push_back(it == points.end() ? -1 : static_cast<int>(it - points.begin()));
  }
  return match;
}

}  // namespace

LandmarkErrors landmark_errors(const LandmarkMap& map, std::span<const KnownLandmark> known,
                               const LandmarkErrorParameters& parameters) {
  std::vector<const LandmarkEstimate*> points;
  for (const LandmarkEstimate& l : map.landmarks) {
    if (l.kind == LandmarkKind::point && l.parameters.allFinite()) points.push_back(&l);
  }
  const std::vector<int> match = associate_landmarks(points, known, parameters);
  std::vector<Vector2> estimate, truth;
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (match[i] < 0) continue;
    estimate.emplace_back(points[static_cast<std::size_t>(match[i])]->parameters.head<2>());
    truth.push_back(known[i].position);
  }
  const Similarity2 s = align(estimate, truth, parameters.alignment);
  Accumulator error;
  for (std::size_t i = 0; i < estimate.size(); ++i) error.add((s * estimate[i] - truth[i]).norm());
  return {error.samples,
          static_cast<int>(known.size()) - error.samples,
          static_cast<int>(points.size()) - error.samples,
          error.rms(),
          error.mean(),
          error.maximum()};
}

}  // namespace noctule::eval
