#include "filters/slam/ekf_slam.hpp"

#include <algorithm>
#include <cmath>

#include "core/assignment.hpp"
#include "core/check.hpp"
#include "core/chi2.hpp"
#include "core/error.hpp"
#include "core/limits.hpp"
#include "filters/checks.hpp"
#include "filters/slam/joint_compatibility.hpp"
#include "models/range_bearing.hpp"

namespace noctule::filters {

EkfSlam::EkfSlam(const EkfSlamParameters& parameters, const Pose2& start)
    : rule_(parameters.sightings),
      life_(parameters.life),
      mean_(start.vector()),
      covariance_(Eigen::MatrixXd::Zero(3, 3)) {
  require_sound(parameters, "EKF-SLAM");
  if (!start.finite()) throw InputError("EKF-SLAM: start: expected a finite pose");
  estimate_.pose = start;
}

void EkfSlam::predict(const Odometry& odometry) {
  check(odometry);
  const Pose2 before = pose();
  const Matrix3 by_pose = compose_jacobian_left(before, odometry.increment);
  const Matrix3 by_motion = compose_jacobian_right(before);
  mean_.head<3>() = (before * odometry.increment).vector();
  const Eigen::Index rest = size() - 3;
  covariance_.block(0, 3, 3, rest) = (by_pose * covariance_.block(0, 3, 3, rest)).eval();
  covariance_.block(3, 0, rest, 3) = covariance_.block(0, 3, 3, rest).transpose();
  Matrix3 p = covariance_.topLeftCorner<3, 3>();
  p = (by_pose * p * by_pose.transpose() + by_motion * odometry.covariance * by_motion.transpose()).eval();
  symmetrise(p);
  covariance_.topLeftCorner<3, 3>() = p;
}

void EkfSlam::update(const UltrasonicScan&, const ContourFeatures&) {
  throw InputError("ultrasonic scan: this filter hears nothing; choose type: pf");
}

void EkfSlam::update(const LandmarkDetections& message) {
  check(message);
  check_order("landmark detections", message.stamp, last_detections_);
  // In the order of their names, so that no result depends on how they were sent.
  LandmarkDetections detections = message;
  std::ranges::stable_sort(detections.detections, {}, &LandmarkDetection::id);
  sensor_in_base_ = detections.sensor_in_base;
  estimate_.nis = 0.0;
  associate(detections);
  take_in();
  const std::size_t size_before = landmarks_.size();
  for (const std::size_t k : new_) {
    const LandmarkDetection& z = detections.detections[k];
    start(z, z.id >= 0 ? z.id : next_id_ - static_cast<std::int64_t>(k));
  }
  next_id_ -= static_cast<std::int64_t>(detections.detections.size());
  if (life_) live(size_before);

  estimate_.stamp = detections.stamp;
  estimate_.pose = pose();
  estimate_.covariance = covariance_.topLeftCorner<3, 3>();
  path_.push_back({detections.stamp.seq, detections.stamp.utime, pose()});
}

EkfSlam::Match EkfSlam::match(const LandmarkDetection& z, std::size_t landmark) const {
  const Pose2 base = pose(), sensor = base * sensor_in_base_;
  const Vector2 m = position(landmark);
  const Sighting sighting(z, 0);
  const Innovation v = innovation<double>(sighting, sensor, m.x(), m.y());
  Match result{landmark, {v.range, v.bearing}, {}, {}, sighting.numbers()};
  // The pose itself is the motion, in the frame of the map.
  result.jacobian.leftCols<3>() = by_motion(v, {1.0, 0.0}, sensor.position() - base.position());
  result.jacobian.rightCols<2>() << v.ux, v.uy, -v.inverse_range * v.uy, v.inverse_range * v.ux;
  result.noise << sighting.rr, sighting.rb, sighting.rb, sighting.bb;
  if (!sighting.is_whole()) {
    const Eigen::Index unmeasured = z.kind == DetectionKind::bearing_only ? 0 : 1;
    result.innovation[unmeasured] = 0.0;
    result.jacobian.row(unmeasured).setZero();
  }
  return result;
}

Matrix2 EkfSlam::innovation_covariance(const Match& m) const {
  const Eigen::Index at = row(m.landmark);
  Eigen::Matrix<double, 5, 5> p;
  p << covariance_.topLeftCorner<3, 3>(), covariance_.block<3, 2>(0, at), covariance_.block<2, 3>(at, 0),
      covariance_.block<2, 2>(at, at);
  return m.jacobian * p * m.jacobian.transpose() + m.noise;
}

/// Squared Mahalanobis distance, as of two numbers.
double EkfSlam::distance2(const Match& m) const {
  const auto llt = cholesky<2>(innovation_covariance(m));
  return llt.matrixL().solve(m.innovation).squaredNorm() * (m.numbers == 2 ? 1.0 : rule_.one_number);
}

void EkfSlam::associate(const LandmarkDetections& message) {
  matches_.clear();
  new_.clear();
  std::vector<std::size_t> unnamed;
  for (std::size_t k = 0; k < message.detections.size(); ++k) {
    const LandmarkDetection& z = message.detections[k];
    if (z.id < 0) {
      unnamed.push_back(k);
    } else if (const auto found = named_.find(z.id); found != named_.end()) {
      const Match m = match(z, found->second);
      if (rule_.parameters.named_gate == 0.0 || distance2(m) <= rule_.parameters.named_gate) matches_.push_back(m);
    } else if (z.kind != DetectionKind::range_bearing) {
      continue;
    } else if (std::ranges::none_of(new_, [&](std::size_t j) { return message.detections[j].id == z.id; })) {
      new_.push_back(k);
    }
  }
  if (!unnamed.empty()) associate_unnamed(message, unnamed);
}

/// Individual compatibility within a gate; then the most likely assignment, each sighting to its likeliest landmark, or
/// the largest set that is compatible together.
void EkfSlam::associate_unnamed(const LandmarkDetections& message, const std::vector<std::size_t>& rows) {
  const SightingParameters& p = rule_.parameters;
  const std::size_t taken = matches_.size(), columns = landmarks_.size();
  const auto is_taken = [&](std::size_t j) {
    return std::any_of(matches_.begin(), matches_.begin() + static_cast<std::ptrdiff_t>(taken),
                       [j](const Match& m) { return m.landmark == j; });
  };
  Eigen::MatrixXd cost =
      Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns), kInf);
  std::vector<double> nearest(rows.size(), kInf);
  std::vector<std::vector<Match>> compatible(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      if (is_taken(j)) continue;
      const Match m = match(message.detections[rows[i]], j);
      const auto llt = cholesky<2>(innovation_covariance(m));
      const double distance =
          llt.matrixL().solve(m.innovation).squaredNorm() * (m.numbers == 2 ? 1.0 : rule_.one_number);
      nearest[i] = std::min(nearest[i], distance);
      const double unmeasured = m.numbers == 2 ? 0.0 : 0.5 * std::log(kTwoPi);  // of the number that never strays
      if (distance > p.gate) continue;
      compatible[i].push_back(m);
      cost(i, j) =
          rule_.log_density_of_new(message.detections[rows[i]].kind) - unmeasured - log_gaussian<2>(m.innovation, llt);
    }
  }
  std::vector<int> column_of(rows.size(), -1);
  if (columns > 0 && p.match == Matching::likelihood) {
    column_of = assign(cost, 0.0);
  } else if (columns > 0 && p.match == Matching::joint) {
    column_of = match_jointly(compatible);
  } else if (columns > 0) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      int j = 0;
      if (cost.row(static_cast<Eigen::Index>(i)).minCoeff(&j) < kInf) column_of[i] = j;
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (column_of[i] >= 0) {
      matches_.push_back(match(message.detections[rows[i]], static_cast<std::size_t>(column_of[i])));
    } else if (nearest[i] > p.new_above && message.detections[rows[i]].kind == DetectionKind::range_bearing) {
      new_.push_back(rows[i]);
    }
  }
}

/// Together with those whose identity is known, which are beyond doubt.
std::vector<int> EkfSlam::match_jointly(const std::vector<std::vector<Match>>& compatible) const {
  std::vector<Match> all = matches_;
  std::vector<Pairing> pairings;
  for (const Match& m : all) pairings.push_back({pairings.size(), m.landmark, m.numbers});
  for (std::size_t i = 0; i < compatible.size(); ++i) {
    for (const Match& m : compatible[i]) {
      all.push_back(m);
      pairings.push_back({matches_.size() + i, m.landmark, m.numbers});
    }
  }
  Eigen::MatrixXd pht, s;
  stack(all, pht, s);
  Eigen::VectorXd innovations(s.rows());
  for (std::size_t k = 0; k < all.size(); ++k) {
    innovations.segment<2>(2 * static_cast<Eigen::Index>(k)) = all[k].innovation;
  }
  std::vector<int> column_of(compatible.size(), -1);
  const double probability = chi2_cdf(rule_.parameters.gate, 2);
  for (const std::size_t k : jointly_compatible(pairings, innovations, s, probability)) {
    if (k < matches_.size()) continue;
    column_of[pairings[k].sighting - matches_.size()] = static_cast<int>(pairings[k].landmark);
  }
  return column_of;
}

/// P H' and H P H' + R of all matches, one block after the other.
void EkfSlam::stack(std::span<const Match> matches, Eigen::MatrixXd& pht, Eigen::MatrixXd& s) const {
  const Eigen::Index n = size(), m = 2 * static_cast<Eigen::Index>(matches.size());
  pht.resize(n, m);
  s.resize(m, m);
  for (Eigen::Index k = 0; k < m / 2; ++k) {
    const Match& a = matches[static_cast<std::size_t>(k)];
    pht.middleCols<2>(2 * k) = covariance_.topLeftCorner(n, 3) * a.jacobian.leftCols<3>().transpose() +
                               covariance_.block(0, row(a.landmark), n, 2) * a.jacobian.rightCols<2>().transpose();
  }
  for (Eigen::Index k = 0; k < m / 2; ++k) {
    const Match& a = matches[static_cast<std::size_t>(k)];
    s.middleRows<2>(2 * k) =
        a.jacobian.leftCols<3>() * pht.topRows<3>() + a.jacobian.rightCols<2>() * pht.middleRows<2>(row(a.landmark));
    s.block<2, 2>(2 * k, 2 * k) += a.noise;
  }
  symmetrise(s);
}

void EkfSlam::take_in() {
  if (matches_.empty()) return;
  const Eigen::Index n = size(), m = 2 * static_cast<Eigen::Index>(matches_.size());
  Eigen::MatrixXd pht, s;
  stack(matches_, pht, s);
  Eigen::VectorXd innovation(m);
  int numbers = 0;
  for (Eigen::Index k = 0; k < m / 2; ++k) {
    innovation.segment<2>(2 * k) = matches_[static_cast<std::size_t>(k)].innovation;
    numbers += matches_[static_cast<std::size_t>(k)].numbers;
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(s);
  const Eigen::VectorXd y = llt.matrixL().solve(innovation);
  if (llt.info() != Eigen::Success || !(y.squaredNorm() < kInf)) {
    ++collapses_;  // impossible: nothing to be learned from it
    return;
  }
  const Eigen::MatrixXd w = llt.matrixL().solve(pht.transpose());  // transposed
  mean_ += w.transpose() * y;
  mean_[2] = wrap(mean_[2]);
  auto p = covariance_.topLeftCorner(n, n);
  p.selfadjointView<Eigen::Lower>().rankUpdate(w.transpose(), -1.0);
  p.triangularView<Eigen::StrictlyUpper>() = p.transpose();
  for (const Match& a : matches_) ++landmarks_[a.landmark].observations;
  estimate_.nis = y.squaredNorm() / numbers;
}

void EkfSlam::start(const LandmarkDetection& z, std::int64_t id) {
  const Eigen::Index n = size();
  if (covariance_.rows() < n + 2) {
    Eigen::MatrixXd wider = Eigen::MatrixXd::Zero(2 * n + 2, 2 * n + 2);
    wider.topLeftCorner(n, n) = covariance_.topLeftCorner(n, n);
    covariance_ = std::move(wider);
  }
  const Pose2 base = pose(), sensor = base * sensor_in_base_;
  const auto placed = models::place_landmark(sensor, {z.range, z.bearing});
  Eigen::Matrix<double, 2, 3> by_pose = Eigen::Matrix<double, 2, 3>::Identity();
  const Vector2 d = placed.landmark - base.position();
  by_pose(0, 2) = -d.y();
  by_pose(1, 2) = d.x();
  covariance_.block(n, 0, 2, n) = by_pose * covariance_.topLeftCorner(3, n);
  covariance_.block(0, n, n, 2) = covariance_.block(n, 0, 2, n).transpose();
  Matrix2 p = by_pose * covariance_.topLeftCorner<3, 3>() * by_pose.transpose() +
              placed.by_sighting * z.covariance * placed.by_sighting.transpose();
  symmetrise(p);
  covariance_.block<2, 2>(n, n) = p;
  mean_.conservativeResize(n + 2);
  mean_.tail<2>() = placed.landmark;
  if (id >= 0) named_.emplace(id, landmarks_.size());
  landmarks_.push_back({id, 1});
}

void EkfSlam::begin_on(const LandmarkMap& map, const ParticleCloud& poses) {
  const std::vector<PointLandmark> known = point_landmarks(map);
  if (poses.particles.empty()) throw InputError("poses to begin at: expected some, got none");
  double total = 0.0, cosine = 0.0, sine = 0.0;
  Pose2 mean;
  for (const auto& [pose, weight] : poses.particles) {
    total += weight;
    mean.x += weight * pose.x;
    mean.y += weight * pose.y;
    cosine += weight * std::cos(pose.yaw);
    sine += weight * std::sin(pose.yaw);
  }
  mean = {mean.x / total, mean.y / total, std::atan2(sine, cosine)};
  Matrix3 spread = Matrix3::Zero();
  for (const auto& [pose, weight] : poses.particles) {
    const Vector3 d = difference(pose, mean);
    spread += weight / total * d * d.transpose();
  }
  const auto existence = static_cast<float>(life_ ? life_->confirm_above : 0.0);
  for (const PointLandmark& m : known) landmarks_.push_back({m.id, m.observations, existence});
  mean_.resize(size());
  mean_.head<3>() = mean.vector();
  covariance_ = Eigen::MatrixXd::Zero(size(), size());
  covariance_.topLeftCorner<3, 3>() = spread;
  for (std::size_t k = 0; k < known.size(); ++k) {
    mean_.segment<2>(row(k)) = known[k].position();
    covariance_.block<2, 2>(row(k), row(k)) = known[k].covariance();
    if (known[k].id >= 0) named_.emplace(known[k].id, k);
    next_id_ = std::min(next_id_, known[k].id - 1);
  }
  estimate_.pose = pose();
  estimate_.covariance = spread;
}

void EkfSlam::transfer(StateArchive& archive) {
  archive(mean_, covariance_, next_id_, collapses_, last_detections_);
  archive.each(landmarks_, Named{}, [&](Named& n) { archive(n.id, n.observations, n.existence); });
  archive.each(path_, PathPose{}, [&](PathPose& p) { archive(p.scan_seq, p.utime, p.pose); });
  archive(estimate_.stamp, estimate_.pose, estimate_.covariance, estimate_.nis);
  if (!archive.reads()) return;
  if (mean_.size() != size() || covariance_.rows() < size()) throw InputError("state: expected that of EKF-SLAM");
  named_.clear();
  for (std::size_t k = 0; k < landmarks_.size(); ++k) {
    if (landmarks_[k].id >= 0) named_.emplace(landmarks_[k].id, k);
  }
}

LandmarkMap EkfSlam::map() const {
  LandmarkMap result{estimate_.stamp, {}};
  for (std::size_t k = 0; k < landmarks_.size(); ++k) {
    if (life_ && landmarks_[k].id < 0 && landmarks_[k].existence < life_->confirm_above) continue;
    LandmarkEstimate& e = result.landmarks.emplace_back();
    e.id = landmarks_[k].id;
    e.parameters.head<2>() = position(k);
    e.covariance.topLeftCorner<2, 2>() = covariance_.block<2, 2>(row(k), row(k));
    e.observations = landmarks_[k].observations;
  }
  return result;
}

}  // namespace noctule::filters
