#include "filters/localisation/ekf_localisation.hpp"

#include <algorithm>
#include <limits>

#include "core/assignment.hpp"
#include "core/check.hpp"
#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "core/observation_checks.hpp"
#include "models/range_bearing.hpp"

namespace noctule::filters {

struct EkfLocalisation::Match {
  Vector2 innovation;
  Eigen::Matrix<double, 2, 3> jacobian;  ///< by the pose of the base
  double distance2;                      ///< squared Mahalanobis
  double log_likelihood;
};

EkfLocalisation::EkfLocalisation(std::vector<KnownLandmark> map, const Pose2& start,
                                 const EkfLocalisationParameters& parameters)
    : map_(std::move(map)), parameters_(parameters), pose_{start, Matrix3::Zero()} {
  require_sound(parameters, "EKF localisation");
  if (!start.finite()) throw InputError("start: expected finite numbers");
  for (const KnownLandmark& l : map_) {
    if (!l.position.allFinite()) throw InputError("landmark " + std::to_string(l.id) + ": expected finite numbers");
  }
}

void EkfLocalisation::predict(const Odometry& odometry) {
  check(odometry);
  pose_ = pose_ * PoseGaussian{odometry.increment, odometry.covariance};
}

EkfLocalisation::Match EkfLocalisation::match(const LandmarkDetection& sighting, const Pose2& sensor_in_base,
                                              const KnownLandmark& landmark) const {
  const auto prediction = models::predict_range_bearing(pose_.mean * sensor_in_base, landmark.position);
  Eigen::Matrix<double, 2, 3> by_sensor;
  by_sensor << -prediction.by_landmark, Vector2(0.0, -1.0);
  Match m;
  m.innovation << sighting.range - prediction.z[0], wrap(sighting.bearing - prediction.z[1]);
  m.jacobian = by_sensor * compose_jacobian_left(pose_.mean, sensor_in_base);
  const auto llt = cholesky<2>(m.jacobian * pose_.covariance * m.jacobian.transpose() + sighting.covariance);
  m.distance2 = llt.matrixL().solve(m.innovation).squaredNorm();
  m.log_likelihood = log_gaussian<2>(m.innovation, llt);
  return m;
}

std::vector<const KnownLandmark*> EkfLocalisation::associate(const LandmarkDetections& message) const {
  constexpr double kForbidden = std::numeric_limits<double>::infinity();
  const auto& sightings = message.detections;
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(std::ssize(sightings), std::ssize(map_), kForbidden);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    for (std::size_t j = 0; j < map_.size(); ++j) {
      if (sightings[i].id >= 0 && sightings[i].id != map_[j].id) continue;
      const Match m = match(sightings[i], message.sensor_in_base, map_[j]);
      if (m.distance2 > parameters_.gate) continue;
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = -m.log_likelihood;
    }
  }
  std::vector<const KnownLandmark*> landmarks;
  for (const int column : assign(cost, kForbidden)) {
    landmarks.push_back(column < 0 ? nullptr : &map_[static_cast<std::size_t>(column)]);
  }
  return landmarks;
}

void EkfLocalisation::update(const LandmarkDetections& message) {
  check_whole(message);
  const std::vector<const KnownLandmark*> landmarks = associate(message);
  double sum = 0.0;
  int dof = 0;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i] == nullptr) continue;
    const Match m = match(message.detections[i], message.sensor_in_base, *landmarks[i]);
    Vector3 mean = pose_.mean.vector();
    sum += joseph_update<3, 2>(mean, pose_.covariance, m.innovation, m.jacobian, message.detections[i].covariance).nis;
    dof += 2;
    pose_.mean = {mean[0], mean[1], wrap(mean[2])};
  }
  nis_ = dof > 0 ? sum / dof : 0.0;
}

}  // namespace noctule::filters
