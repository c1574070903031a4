#include "filters/checks.hpp"

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

}  // namespace

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

void check_order(const char* what, const Stamp& stamp, std::optional<std::int64_t>& last) {
  if (last && stamp.seq <= *last) {
    refuse(what, ": seq: expected a number above ", *last, " (every reading enters once), got ", stamp.seq);
  }
  last = stamp.seq;
}

}  // namespace noctule::filters
