#include "filters/checks.hpp"

#include <Eigen/LU>
#include <cmath>
#include <sstream>

#include "core/error.hpp"

namespace noctule::filters {
namespace {

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw InputError(text.str());
}

bool finite(const Vector2& v) {
  return v.allFinite();
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

void check(const UltrasonicScan& scan) {
  if (!(scan.half_angle > 0.0 && scan.half_angle <= kPi)) {
    refuse("ultrasonic scan ", scan.stamp.seq, ": half angle: expected radians in (0, pi], got ", scan.half_angle);
  }
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    const UltrasonicBeam& beam = scan.beams[i];
    if (!beam.sensor_in_base.finite()) {
      refuse("ultrasonic scan ", scan.stamp.seq, ", beam ", i, ": sensor pose: expected finite numbers, got (",
             beam.sensor_in_base.x, ", ", beam.sensor_in_base.y, ", ", beam.sensor_in_base.yaw, ")");
    }
    if (beam.echo == Echo::hit && !(beam.range > 0.0 && std::isfinite(beam.range))) {
      refuse("ultrasonic scan ", scan.stamp.seq, ", beam ", i, ": range of a hit: expected metres > 0, got ",
             beam.range);
    }
  }
}

void check(const ContourFeatures& features, const UltrasonicScan& scan) {
  for (std::size_t k = 0; k < features.features.size(); ++k) {
    const ContourFeature& f = features.features[k];
    const auto place = [&] {
      return "contour features " + std::to_string(features.stamp.seq) + ", feature " + std::to_string(k);
    };
    const bool wall = std::isfinite(f.wall.rho) && std::isfinite(f.wall.theta);
    const bool circle =
        finite(f.circle.centre) && std::isfinite(f.circle.radius) && !std::isnan(f.circle_covariance(2, 2));
    if (!wall || !circle || !finite(f.surface)) refuse(place(), ": expected finite numbers, got NaN or infinity");
    for (const ReadingId& reading : f.readings) {
      if (reading.scan_seq != scan.stamp.seq) continue;
      if (reading.beam < 0 || static_cast<std::size_t>(reading.beam) >= scan.beams.size()) {
        refuse(place(), ": reading of scan ", reading.scan_seq, ": expected a beam below ", scan.beams.size(), ", got ",
               reading.beam);
      }
    }
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
    if (d.kind != DetectionKind::range_bearing) {
      refuse(place(), ": kind: expected range_bearing, got ",
             d.kind == DetectionKind::bearing_only ? "bearing_only" : "range_only", ", which this filter cannot use");
    }
    if (!(d.range > 0.0 && std::isfinite(d.range))) refuse(place(), ": range: expected metres > 0, got ", d.range);
    if (!std::isfinite(d.bearing)) refuse(place(), ": bearing: expected radians, got ", d.bearing);
    if (!is_covariance(d.covariance) || !(d.covariance(0, 0) > 0.0) || !(d.covariance.determinant() > 0.0)) {
      refuse(place(), ": covariance: expected a positive definite matrix, got ", d.covariance.reshaped().transpose());
    }
    if (d.id < -1) refuse(place(), ": id: expected -1 (unknown) or >= 0, got ", d.id);
  }
}

}  // namespace noctule::filters
