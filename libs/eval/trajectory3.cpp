#include "eval/trajectory3.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>

namespace noctule::eval {
namespace {

const TimedPose3* nearest(std::span<const TimedPose3> trajectory, std::int64_t utime) {
  if (trajectory.empty()) return nullptr;
  const auto after = std::ranges::lower_bound(trajectory, utime, {}, &TimedPose3::utime);
  if (after == trajectory.begin()) return &*after;
  const auto before = std::prev(after);
  return after != trajectory.end() && after->utime - utime < utime - before->utime ? &*after : &*before;
}

std::optional<Pose3> interpolate(std::span<const TimedPose3> trajectory, std::int64_t utime, double max_gap) {
  const auto after = std::ranges::lower_bound(trajectory, utime, {}, &TimedPose3::utime);
  if (after == trajectory.end()) return std::nullopt;
  if (after->utime == utime) return after->pose;
  if (after == trajectory.begin()) return std::nullopt;
  const TimedPose3& a = *std::prev(after);
  const TimedPose3& b = *after;
  if (seconds(b.utime - a.utime) > max_gap) return std::nullopt;
  const double part = static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  return Pose3{a.pose.position + part * (b.pose.position - a.pose.position),
               a.pose.rotation.slerp(part, b.pose.rotation)};
}

/// Angle of a rotation, exact for small ones too.
double angle(const Eigen::Quaterniond& q) {
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

Vector3 mean(std::span<const Vector3> points) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

Pose3 operator*(const Pose3& a, const Pose3& b) {
  return {a.position + a.rotation * b.position, (a.rotation * b.rotation).normalized()};
}

Pose3 between(const Pose3& a, const Pose3& b) {
  const Eigen::Quaterniond back = a.rotation.conjugate();
  return {back * (b.position - a.position), (back * b.rotation).normalized()};
}

Pose3 in_space(const Pose2& p) {
  return {{p.x, p.y, 0.0}, Eigen::Quaterniond(std::cos(0.5 * p.yaw), 0.0, 0.0, std::sin(0.5 * p.yaw))};
}

Pose2 in_plane(const Pose3& p) {
  const Matrix3 r = p.rotation.toRotationMatrix();
  return {p.position.x(), p.position.y(), std::atan2(r(1, 0), r(0, 0))};
}

std::vector<PosePair3> associate_nearest(std::span<const TimedPose3> estimate, std::span<const TimedPose3> truth,
                                         double max_difference) {
  const bool truth_is_shorter = truth.size() < estimate.size();
  std::vector<PosePair3> pairs;
  for (const TimedPose3& p : truth_is_shorter ? truth : estimate) {
    const TimedPose3* other = nearest(truth_is_shorter ? estimate : truth, p.utime);
    if (other == nullptr || seconds(std::abs(other->utime - p.utime)) > max_difference) continue;
    pairs.push_back(truth_is_shorter ? PosePair3{p.utime, other->pose, p.pose}
                                     : PosePair3{p.utime, p.pose, other->pose});
  }
  return pairs;
}

std::vector<PosePair3> associate_interpolated(std::span<const TimedPose3> estimate, std::span<const TimedPose3> truth,
                                              double max_gap) {
  std::vector<PosePair3> pairs;
  for (const TimedPose3& e : estimate) {
    if (const auto t = interpolate(truth, e.utime, max_gap)) pairs.push_back({e.utime, e.pose, *t});
  }
  return pairs;
}

Pose3 Similarity3::operator*(const Pose3& p) const {
  return {*this * p.position, (Eigen::Quaterniond(rotation) * p.rotation).normalized()};
}

Similarity3 align(std::span<const Vector3> source, std::span<const Vector3> target, Alignment3 alignment) {
  if (source.size() != target.size()) throw std::invalid_argument("align: source and target differ in length");
  Similarity3 s;
  if (alignment == Alignment3::none || source.empty()) return s;
  const Vector3 source_mean = mean(source), target_mean = mean(target);
  Matrix3 covariance = Matrix3::Zero();
  double variance = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    covariance += (target[i] - target_mean) * (source[i] - source_mean).transpose();
    variance += (source[i] - source_mean).squaredNorm();
  }
  if (alignment == Alignment3::yaw) {
    const double dot = covariance(0, 0) + covariance(1, 1), cross = covariance(1, 0) - covariance(0, 1);
    s.rotation = Eigen::AngleAxisd(std::atan2(cross, dot), Vector3::UnitZ()).toRotationMatrix();
  } else {
    const Eigen::JacobiSVD<Matrix3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vector3 sign = Vector3::Ones();
    if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign[2] = -1.0;
    s.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    if (alignment == Alignment3::similarity && variance > 0.0) s.scale = svd.singularValues().dot(sign) / variance;
  }
  s.translation = target_mean - s.scale * (s.rotation * source_mean);
  return s;
}

Similarity3 align(std::span<const PosePair3> pairs, Alignment3 alignment) {
  std::vector<Vector3> estimate, truth;
  for (const PosePair3& p : pairs) {
    estimate.push_back(p.estimate.position);
    truth.push_back(p.truth.position);
  }
  return align(estimate, truth, alignment);
}

std::vector<PosePair3> aligned(std::span<const PosePair3> pairs, const Similarity3& similarity) {
  std::vector<PosePair3> moved(pairs.begin(), pairs.end());
  for (PosePair3& p : moved) p.estimate = similarity * p.estimate;
  return moved;
}

PoseErrorSeries absolute_errors(std::span<const PosePair3> pairs) {
  PoseErrorSeries errors;
  for (const PosePair3& p : pairs) {
    errors.translation.push_back((p.estimate.position - p.truth.position).norm());
    errors.rotation.push_back(angle(p.truth.rotation.conjugate() * p.estimate.rotation));
  }
  return errors;
}

PoseErrorSeries relative_errors(std::span<const PosePair3> pairs, std::span<const Segment> segments) {
  PoseErrorSeries errors;
  for (const auto& [i, j] : segments) {
    const Pose3 truth = between(pairs[i].truth, pairs[j].truth);
    const Pose3 error = between(truth, between(pairs[i].estimate, pairs[j].estimate));
    errors.translation.push_back(error.position.norm());
    errors.rotation.push_back(angle(error.rotation));
  }
  return errors;
}

std::vector<double> travelled(std::span<const PosePair3> pairs) {
  std::vector<double> way(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    way[i] = way[i - 1] + (pairs[i].truth.position - pairs[i - 1].truth.position).norm();
  }
  return way;
}

Drift drift(std::span<const PosePair3> pairs, std::span<const double> lengths, std::size_t every) {
  if (every == 0) throw std::invalid_argument("drift: segments must begin at every 1, 2, ... poses");
  const std::vector<double> way = travelled(pairs);
  Drift d;
  for (const double length : lengths) {
    std::vector<Segment> segments = segments_by_distance(way, length, SegmentStarts::every_pose);
    std::erase_if(segments, [&](const Segment& s) { return s.first % every != 0; });
    const PoseErrorSeries errors = relative_errors(pairs, segments);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      d.translation += errors.translation[i] / length;
      d.rotation += errors.rotation[i] / length;
    }
    d.segments += static_cast<int>(segments.size());
  }
  // 0 / 0 is the NaN that says so.
  d.translation /= d.segments;
  d.rotation /= d.segments;
  return d;
}

}  // namespace noctule::eval
