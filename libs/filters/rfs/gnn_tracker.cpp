#include "filters/rfs/gnn_tracker.hpp"

#include <cmath>
#include <limits>
#include <sstream>

#include "core/assignment.hpp"
#include "core/check.hpp"
#include "core/error.hpp"
#include "core/gaussian.hpp"

namespace noctule::filters {
namespace {

constexpr double kForbidden = std::numeric_limits<double>::infinity();

/// One-step prediction and update of a single object, shared in the scan.
class ObjectKalman {
 public:
  explicit ObjectKalman(const ObjectModel& model)
      : f_(model.motion().transition()),
        q_(model.motion().noise()),
        r_(model.position_sd * model.position_sd * Matrix2::Identity()) {}

  void predict(ObjectEstimate& o) const {
    o.state = f_ * o.state;
    o.covariance = f_ * o.covariance * f_.transpose() + q_;
  }
  /// log likelihood of a measurement, nothing beyond the gate: +inf as a cost.
  [[nodiscard]] double cost(const ObjectEstimate& o, const Vector2& z, double gate) const {
    const Matrix2 s = h_ * o.covariance * h_.transpose() + r_;
    const auto llt = cholesky<2>(s);
    const Vector2 innovation = z - h_ * o.state;
    if (llt.matrixL().solve(innovation).squaredNorm() > gate) return kForbidden;
    return -log_gaussian<2>(innovation, llt);
  }
  void update(ObjectEstimate& o, const Vector2& z) const {
    joseph_update<4, 2>(o.state, o.covariance, z - h_ * o.state, h_, r_);
  }

 private:
  models::Matrix4 f_, q_;
  models::Matrix24 h_ = models::ConstantVelocity::position();
  Matrix2 r_;
};

}  // namespace

GnnTracker::GnnTracker(const GnnTrackerParameters& parameters) : parameters_(parameters) {
  require_sound(parameters, "GNN tracker");
}

void GnnTracker::associate(bool confirmed, std::span<const Vector2> measurements, std::vector<bool>& taken) {
  const ObjectKalman kalman(parameters_.model);
  std::vector<Track*> rows;
  for (Track& t : tracks_) {
    if (t.confirmed == confirmed) rows.push_back(&t);
  }
  std::vector<std::size_t> columns;
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (!taken[j]) columns.push_back(j);
  }
  Eigen::MatrixXd cost(rows.size(), columns.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) {
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          kalman.cost(rows[i]->object, measurements[columns[j]], parameters_.gate);
    }
  }
  // p_D N(z) against (1 - p_D) times the density of false alarms.
  const double p = parameters_.model.detection;
  const std::vector<int> column = assign(cost, -std::log(parameters_.model.clutter_density * (1.0 - p) / p));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ++rows[i]->scans;
    if (column[i] < 0) {
      ++rows[i]->misses;
      continue;
    }
    const std::size_t j = columns[static_cast<std::size_t>(column[i])];
    taken[j] = true;
    kalman.update(rows[i]->object, measurements[j]);
    ++rows[i]->hits;
    rows[i]->misses = 0;
  }
}

void GnnTracker::update(std::span<const Vector2> measurements) {
  for (const Vector2& z : measurements) {
    if (z.allFinite()) continue;
    std::ostringstream text;
    text << "measurement: expected finite numbers, got (" << z.x() << ", " << z.y() << ')';
    throw InputError(text.str());
  }
  const ObjectKalman kalman(parameters_.model);
  for (Track& t : tracks_) kalman.predict(t.object);
  std::vector<bool> taken(measurements.size(), false);
  associate(true, measurements, taken);
  associate(false, measurements, taken);
  std::erase_if(tracks_, [&](Track& t) {
    if (t.confirmed) return t.misses >= parameters_.delete_misses;
    t.confirmed = t.hits >= parameters_.confirm_hits;
    return !t.confirmed && t.scans >= parameters_.confirm_scans;
  });
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    if (taken[j]) continue;
    tracks_.push_back({.object = parameters_.model.first_seen(next_label_++, measurements[j])});
    tracks_.back().confirmed = parameters_.confirm_hits <= 1;
  }
}

std::vector<ObjectEstimate> GnnTracker::objects() const {
  std::vector<ObjectEstimate> objects;
  for (const Track& t : tracks_) {
    if (t.confirmed) objects.push_back(t.object);
  }
  return objects;
}

}  // namespace noctule::filters
