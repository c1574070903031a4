#include "filters/slam/sightings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/assignment.hpp"
#include "core/gaussian.hpp"
#include "models/range_bearing.hpp"

namespace noctule::filters {
namespace {

/// Innovation of a sighting of a landmark.
struct Match {
  Vector2 innovation;
  Matrix2 jacobian;
  double log_likelihood;
  double distance2;  ///< squared Mahalanobis
};

Match match(const LandmarkDetection& sighting, const Pose2& sensor, const PointLandmark& landmark) {
  const auto prediction = models::predict_range_bearing(sensor, landmark.position());
  Match m;
  m.innovation << sighting.range - prediction.z[0], wrap(sighting.bearing - prediction.z[1]);
  m.jacobian = prediction.by_landmark;
  const Matrix2 s = m.jacobian * landmark.covariance() * m.jacobian.transpose() + sighting.covariance;
  const auto llt = cholesky<2>(s);
  m.log_likelihood = log_gaussian<2>(m.innovation, llt);
  m.distance2 = llt.matrixL().solve(m.innovation).squaredNorm();
  return m;
}

class Assimilation {
 public:
  Assimilation(const LandmarkDetections& message, const Pose2& base, std::int64_t first_id,
               const SightingParameters& parameters, std::vector<PointLandmark>& map)
      : message_(message),
        sensor_(base * message.sensor_in_base),
        first_id_(first_id),
        parameters_(parameters),
        map_(map) {}

  ObservationFit run() {
    for (const LandmarkDetection& sighting : message_.detections) {
      if (sighting.id >= 0) take_known(sighting);
    }
    take_unknown();
    return fit_;
  }

 private:
  void take_known(const LandmarkDetection& sighting) {
    const auto landmark = std::ranges::find(map_, sighting.id, &PointLandmark::id);
    if (landmark == map_.end()) {
      start(sighting, sighting.id);
    } else {
      update(*landmark, sighting, match(sighting, sensor_, *landmark));
    }
  }

  /// Optimal assignment between the sightings without identity and the landmarks that this message did not name.
  void take_unknown() {
    std::vector<std::size_t> rows, columns;
    for (std::size_t k = 0; k < message_.detections.size(); ++k) {
      if (message_.detections[k].id < 0) rows.push_back(k);
    }
    if (rows.empty()) return;
    for (std::size_t j = 0; j < map_.size(); ++j) {
      const bool named = std::ranges::any_of(message_.detections, [&](const auto& d) { return d.id == map_[j].id; });
      if (!named) columns.push_back(j);
    }
    constexpr double inf = std::numeric_limits<double>::infinity();
    Eigen::MatrixXd cost(rows.size(), columns.size());
    std::vector<double> nearest(rows.size(), inf);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = 0; j < columns.size(); ++j) {
        const Match m = match(message_.detections[rows[i]], sensor_, map_[columns[j]]);
        nearest[i] = std::min(nearest[i], m.distance2);
        cost(i, j) = m.distance2 <= parameters_.gate ? -m.log_likelihood : inf;
      }
    }
    const auto column_of = assign(cost, -std::log(parameters_.new_density));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const LandmarkDetection& sighting = message_.detections[rows[i]];
      if (column_of[i] >= 0) {
        PointLandmark& landmark = map_[columns[static_cast<std::size_t>(column_of[i])]];
        update(landmark, sighting, match(sighting, sensor_, landmark));
      } else if (nearest[i] > parameters_.new_above) {
        start(sighting, first_id_ - static_cast<std::int64_t>(rows[i]));
      } else {
        fit_.log_likelihood += std::log(parameters_.new_density);
      }
    }
  }

  void start(const LandmarkDetection& sighting, std::int64_t id) {
    const auto placed = models::place_landmark(sensor_, {sighting.range, sighting.bearing});
    PointLandmark& m = map_.emplace_back();
    m.set(placed.landmark, placed.by_sighting * sighting.covariance * placed.by_sighting.transpose());
    m.id = id;
    m.observations = 1;
    fit_.log_likelihood += std::log(parameters_.new_density);
  }

  void update(PointLandmark& landmark, const LandmarkDetection& sighting, const Match& m) {
    fit_.log_likelihood += m.log_likelihood;
    fit_.nis += m.distance2;
    fit_.degrees_of_freedom += 2;
    if (!std::isfinite(m.log_likelihood)) return;  // impossible: nothing to be learned from it
    Vector2 position = landmark.position();
    Matrix2 covariance = landmark.covariance();
    joseph_update<2, 2>(position, covariance, m.innovation, m.jacobian, sighting.covariance);
    landmark.set(position, covariance);
    ++landmark.observations;
  }

  const LandmarkDetections& message_;
  Pose2 sensor_;
  std::int64_t first_id_;
  const SightingParameters& parameters_;
  std::vector<PointLandmark>& map_;
  ObservationFit fit_;
};

}  // namespace

ObservationFit apply_sightings(const LandmarkDetections& sightings, const Pose2& base, std::int64_t first_id,
                               const SightingParameters& parameters, std::vector<PointLandmark>& map) {
  return Assimilation(sightings, base, first_id, parameters, map).run();
}

}  // namespace noctule::filters
