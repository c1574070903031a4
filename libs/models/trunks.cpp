#include "models/trunks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace noctule::models {
namespace {

/// The range of a beam, infinity where it hit nothing.
double range_at(const RangeFan& fan, std::size_t beam) {
  const double r = fan.ranges[beam];
  return r > fan.no_return_above || !(r > 0.0) ? std::numeric_limits<double>::infinity() : r;
}

}  // namespace

std::vector<LandmarkDetection> find_trunks(const RangeFan& fan, const TrunkParameters& p) {
  std::vector<LandmarkDetection> trunks;
  const std::size_t size = fan.ranges.size();
  for (std::size_t begin = 0, end = 0; begin < size; begin = end) {
    end = begin + 1;
    double nearest = range_at(fan, begin), farthest = nearest, sum = nearest;
    if (!std::isfinite(nearest)) continue;
    for (; end < size && std::abs(range_at(fan, end) - range_at(fan, end - 1)) <= p.split; ++end) {
      const double r = range_at(fan, end);
      nearest = std::min(nearest, r);
      farthest = std::max(farthest, r);
      sum += r;
    }
    const auto beams = static_cast<double>(end - begin);
    if (begin == 0 || end == size || beams < p.min_beams || nearest > p.max_range) continue;
    const bool free = range_at(fan, begin - 1) > farthest + p.clearance && range_at(fan, end) > farthest + p.clearance;
    if (!free) continue;

    const double beta = 0.5 * beams * fan.step, part = 0.25 * kPi;
    if (beta >= 0.5 * kPi) continue;
    const double distance = (sum / beams) / (1.0 - part * std::sin(beta)), radius = distance * std::sin(beta);
    const double widest =
        distance * std::sin(beta - 0.5 * fan.step);  // of the radius: both edges may lie a beam inside
    if (2.0 * widest > p.max_diameter || farthest - nearest > radius + p.range_sd) continue;

    LandmarkDetection trunk;
    trunk.range = distance;
    trunk.bearing = wrap(fan.first_bearing + 0.5 * static_cast<double>(begin + end - 1) * fan.step);
    // Half the sum and half the difference of two edges, each uniform in one step. An edge beam that just hits changes
    // the radius, and grazing the trunk at its full depth, the mean range as well.
    const double edge_variance = fan.step * fan.step / 24.0;
    const double by_beta = part * distance * (std::cos(beta) / (1.0 - part * std::sin(beta)) + std::sin(beta) / beta);
    trunk.covariance << p.range_sd * p.range_sd + by_beta * by_beta * edge_variance, 0.0, 0.0,
        p.bearing_sd * p.bearing_sd + edge_variance;
    trunks.push_back(trunk);
  }
  return trunks;
}

}  // namespace noctule::models
