#include "core/observation_checks.hpp"

#include <Eigen/LU>
#include <cmath>
#include <sstream>

#include "core/error.hpp"

namespace noctule {
namespace {

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw InputError(text.str());
}

template <class Matrix>
bool is_covariance(const Matrix& m) {
  return m.allFinite() && m.diagonal().minCoeff() >= 0.0 &&
         (m - m.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * (1.0 + m.cwiseAbs().maxCoeff());
}

}  // namespace

void check(const Odometry& o) {
  if (!o.increment.finite()) {
    refuse("odometry ", o.stamp.seq, ": increment: expected finite numbers, got (", o.increment.x, ", ", o.increment.y,
           ", ", o.increment.yaw, ")");
  }
  if (!is_covariance(o.covariance)) {
    refuse("odometry ", o.stamp.seq, ": covariance: expected a symmetric matrix with a diagonal >= 0, got ",
           o.covariance.reshaped().transpose());
  }
}

void check(const LandmarkDetections& message) {
  if (!message.sensor_in_base.finite()) {
    refuse("landmark detections ", message.stamp.seq, ": sensor pose: expected finite numbers");
  }
  for (std::size_t i = 0; i < message.detections.size(); ++i) {
    const LandmarkDetection& d = message.detections[i];
    const auto place = [&] {
      return "landmark detections " + std::to_string(message.stamp.seq) + ", detection " + std::to_string(i);
    };
    const bool ranged = d.kind != DetectionKind::bearing_only, turned = d.kind != DetectionKind::range_only;
    if (ranged && !(d.range > 0.0 && std::isfinite(d.range))) {
      refuse(place(), ": range: expected metres > 0, got ", d.range);
    }
    if (turned && !std::isfinite(d.bearing)) refuse(place(), ": bearing: expected radians, got ", d.bearing);
    const auto is_variance = [](double v) { return v > 0.0 && std::isfinite(v); };
    const bool sound = ranged && turned
                           ? is_covariance(d.covariance) && d.covariance(0, 0) > 0.0 && d.covariance.determinant() > 0.0
                           : is_variance(ranged ? d.covariance(0, 0) : d.covariance(1, 1));
    if (!sound) {
      refuse(place(), ": covariance: expected ",
             ranged && turned ? "a positive definite matrix" : "a positive variance of what is measured", ", got ",
             d.covariance.reshaped().transpose());
    }
    if (d.id < -1) refuse(place(), ": id: expected -1 (unknown) or >= 0, got ", d.id);
  }
}

void check_whole(const LandmarkDetections& message) {
  check(message);
  for (std::size_t i = 0; i < message.detections.size(); ++i) {
    const DetectionKind kind = message.detections[i].kind;
    if (kind == DetectionKind::range_bearing) continue;
    refuse("landmark detections ", message.stamp.seq, ", detection ", i, ": kind: expected range_bearing, got ",
           kind == DetectionKind::bearing_only ? "bearing_only" : "range_only", ", which this estimator cannot use");
  }
}

}  // namespace noctule
