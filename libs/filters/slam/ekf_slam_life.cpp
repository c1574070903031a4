/// Birth, death and merging of the landmarks of EKF-SLAM.
#include <Eigen/Cholesky>

#include "core/gaussian.hpp"
#include "filters/slam/ekf_slam.hpp"

namespace noctule::filters {

/// Birth, death and merging of landmarks that the sensor does not name, after the sightings have been taken in.
void EkfSlam::live(std::size_t size_before) {
  std::vector<char> seen(landmarks_.size(), 0);
  for (const Match& m : matches_) {
    seen[m.landmark] = 1;
    landmarks_[m.landmark].existence += static_cast<float>(life_->seen);
  }
  for (std::size_t k = size_before; k < landmarks_.size(); ++k) {
    seen[k] = 1;
    landmarks_[k].existence = static_cast<float>(life_->born);
  }
  judge_missed(seen);
  if (life_->merge_gate > 0.0) merge_duplicates();
}

/// From the last one on, so that the landmark which takes a place is none that is still to be judged.
void EkfSlam::judge_missed(std::span<const char> seen) {
  const Pose2 sensor = pose() * sensor_in_base_;
  const Matrix3 pose_covariance = covariance_.topLeftCorner<3, 3>();
  for (std::size_t k = seen.size(); k-- > 0;) {
    if (seen[k] != 0 || landmarks_[k].id >= 0) continue;
    PointLandmark m;
    m.set(position(k), covariance_.block<2, 2>(row(k), row(k)));
    if (!should_be_seen(m, sensor, pose_covariance, *life_)) continue;
    landmarks_[k].existence -= static_cast<float>(life_->missed);
    if (landmarks_[k].existence < life_->remove_below) remove(k);  // the last one was judged
  }
}

/// At most one pair a scan.
void EkfSlam::merge_duplicates() {
  for (std::size_t a = 0; a < landmarks_.size(); ++a) {
    if (landmarks_[a].id >= 0) continue;
    for (std::size_t b = a + 1; b < landmarks_.size(); ++b) {
      if (landmarks_[b].id >= 0) continue;
      const Vector2 d = position(b) - position(a);
      const Matrix2 cross = covariance_.block<2, 2>(row(a), row(b));
      const Matrix2 s = covariance_.block<2, 2>(row(a), row(a)) + covariance_.block<2, 2>(row(b), row(b)) - cross -
                        cross.transpose() + 1e-9 * Matrix2::Identity();
      if (mahalanobis2<2>(d, s) < life_->merge_gate) return merge(a, b);
    }
  }
}

/// That two landmarks are at the same place is a measurement of their difference.
void EkfSlam::merge(std::size_t survivor, std::size_t duplicate) {
  const Eigen::Index n = size();
  const Eigen::Matrix<double, Eigen::Dynamic, 2> pht =
      covariance_.block(0, row(survivor), n, 2) - covariance_.block(0, row(duplicate), n, 2);
  Matrix2 s = pht.middleRows<2>(row(survivor)) - pht.middleRows<2>(row(duplicate)) + 1e-9 * Matrix2::Identity();
  symmetrise(s);
  const auto llt = cholesky<2>(s);
  mean_ += pht * llt.solve(position(duplicate) - position(survivor));
  mean_[2] = wrap(mean_[2]);
  auto p = covariance_.topLeftCorner(n, n);
  p -= (pht * llt.solve(pht.transpose())).eval();
  p = (0.5 * (p + p.transpose())).eval();
  Named& kept = landmarks_[survivor];
  kept.existence = std::max(kept.existence, landmarks_[duplicate].existence);
  kept.observations += landmarks_[duplicate].observations;
  remove(duplicate);
}

/// The last one takes its place.
void EkfSlam::remove(std::size_t landmark) {
  const std::size_t last = landmarks_.size() - 1;
  const Eigen::Index n = size(), to = row(landmark), from = row(last);
  if (landmark != last) {
    mean_.segment<2>(to) = mean_.segment<2>(from).eval();
    covariance_.block(to, 0, 2, n) = covariance_.block(from, 0, 2, n).eval();
    covariance_.block(0, to, n, 2) = covariance_.block(0, from, n, 2).eval();
    landmarks_[landmark] = landmarks_[last];
    if (landmarks_[landmark].id >= 0) named_[landmarks_[landmark].id] = landmark;
  }
  landmarks_.pop_back();
  mean_.conservativeResize(size());
}

}  // namespace noctule::filters
