#include "sensors/ultrasonic/depth_regions.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.hpp"
#include "core/log_weights.hpp"

namespace noctule::sensors {
namespace {

constexpr double kOtherObjectShare = 0.3;     ///< of neighbouring pings heard different objects
constexpr double kOtherObjectDensity = 0.25;  ///< of their difference [1/m]
constexpr double kPriorOctaves = 1.5;         ///< sd of the noise scale's prior about 1
constexpr double kSameAngle = 1e-9;           ///< angles closer than this are equal [rad]

[[nodiscard]] double octaves_of(int scale) {
  return 0.25 * scale - 2.0;
}

/// Variance of the difference of two ranges of one surface due to the unknown direction of the echo, when the sensors
/// stand `across` apart at right angles to the mean axis.
[[nodiscard]] double parallax_variance(double across, double half_angle) {
  const double sd = across * half_angle / 3.0;
  return sd * sd;
}

/// Standard deviation, over all phases, of the mean deviation of a run's centre from the echo's direction: 5 % of the
/// step between pings while several fit into half a cone, up to what rounding to the nearest ping gives. Measured with
/// pings that answer with probability 0.98 exp(-2 (a / half)^2).
[[nodiscard]] double grid_bias(double step, double half_angle) {
  const double coarse = std::clamp(2.0 * step / half_angle - 1.0, 0.0, 1.0);
  return step * (0.05 + 0.22 * coarse * coarse);
}

void check(const UltrasonicScan& scan) {
  const auto refuse = [&](const std::string& what) {
    throw InputError("ultrasonic scan " + std::to_string(scan.stamp.seq) + ": " + what);
  };
  if (!(scan.half_angle > 0.0 && scan.half_angle <= 0.5 * kPi))
    refuse("half_angle: expected a number in (0, pi/2] rad, got " + std::to_string(scan.half_angle));
  if (!(scan.min_range >= 0.0 && scan.max_range > scan.min_range && std::isfinite(scan.max_range)))
    refuse("limits: expected 0 <= min_range < max_range in m, got " + std::to_string(scan.min_range) + " and " +
           std::to_string(scan.max_range));
}

}  // namespace

NoiseScale::NoiseScale(double memory) : discount_(std::exp(-1.0 / memory)) {}

void NoiseScale::add(double difference, double nominal_variance, double other_variance) {
  for (int i = 0; i < kScales; ++i) {
    const double octaves = octaves_of(i);
    const double variance = nominal_variance * std::exp2(2.0 * octaves) + other_variance;
    const double same =
        (1.0 - kOtherObjectShare) / std::sqrt(kTwoPi * variance) * std::exp(-0.5 * difference * difference / variance);
    double& log_posterior = log_posterior_[static_cast<std::size_t>(i)];
    log_posterior = discount_ * log_posterior + std::log(same + kOtherObjectShare * kOtherObjectDensity);
  }
  // Only differences between scales matter: keep the numbers small.
  const double top = *std::max_element(log_posterior_.begin(), log_posterior_.end());
  for (double& v : log_posterior_) v -= top;
}

double NoiseScale::value() const {
  double total = 0.0, sum = 0.0;
  for (int i = 0; i < kScales; ++i) {
    const double octaves = octaves_of(i);
    const double weight = std::exp(log_posterior_[static_cast<std::size_t>(i)] -
                                   0.5 * octaves * octaves / (kPriorOctaves * kPriorOctaves));
    total += weight;
    sum += weight * std::exp2(2.0 * octaves);
  }
  return std::sqrt(sum / total);  // variances add up, not logarithms: few data make the scale larger
}

DepthRegionFinder::DepthRegionFinder(const DepthRegionParameters& parameters)
    : parameters_(parameters), noise_scale_(parameters.noise_memory) {}

const std::vector<DepthRegion>& DepthRegionFinder::find(const UltrasonicScan& scan) {
  check(scan);
  regions_.clear();
  collect(scan);
  if (pings_.empty()) return regions_;
  unroll_at_widest_gap();
  learn_noise(scan.half_angle);
  group(scan.half_angle);
  for (std::size_t i = 0; i < run_count_; ++i) summarise(runs_[i], scan.half_angle, regions_.emplace_back());
  return regions_;
}

void DepthRegionFinder::collect(const UltrasonicScan& scan) {
  pings_.clear();
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    const UltrasonicBeam& beam = scan.beams[i];
    if (beam.echo != Echo::hit) continue;
    const bool usable = beam.sensor_in_base.finite() && beam.range >= scan.min_range && beam.range > 0.0 &&
                        beam.range <= scan.max_range;  // false for NaN
    if (!usable) {
      ++ignored_beams_;
      continue;
    }
    pings_.push_back(
        {beam.sensor_in_base.position(), wrap(beam.sensor_in_base.yaw), beam.range, static_cast<std::int32_t>(i)});
  }
}

/// Cuts the circle of axes where no run can pass: at the widest gap, of equal gaps at the greatest step in range.
/// The order then does not depend on the heading of the base.
void DepthRegionFinder::unroll_at_widest_gap() {
  std::sort(pings_.begin(), pings_.end(),
            [](const Ping& a, const Ping& b) { return a.axis != b.axis ? a.axis < b.axis : a.beam < b.beam; });
  std::size_t first = 0;
  double widest = -1.0, greatest_step = -1.0;
  for (std::size_t i = 0; i < pings_.size(); ++i) {
    const Ping& before = pings_[i == 0 ? pings_.size() - 1 : i - 1];
    const double gap = pings_[i].axis - before.axis + (i == 0 ? kTwoPi : 0.0);
    const double step = std::abs(pings_[i].range - before.range);
    if (gap > widest + kSameAngle || (gap > widest - kSameAngle && step > greatest_step)) {
      widest = std::max(gap, widest);
      greatest_step = step;
      first = i;
    }
  }
  for (std::size_t i = 0; i < first; ++i) pings_[i].axis += kTwoPi;
  std::rotate(pings_.begin(), pings_.begin() + static_cast<std::ptrdiff_t>(first), pings_.end());
}

/// Range that a ping would have had at another position if its echo came along `axis`, minus the range it had.
double DepthRegionFinder::displacement(const Ping& from, const Vector2& to, double axis) const {
  return Vector2(std::cos(axis), std::sin(axis)).dot(from.position - to);
}

void DepthRegionFinder::learn_noise(double half_angle) {
  for (std::size_t i = 1; i < pings_.size(); ++i) {
    const Ping &a = pings_[i - 1], &b = pings_[i];
    if (b.axis - a.axis > half_angle + kSameAngle) continue;
    const double axis = 0.5 * (a.axis + b.axis);
    const double difference = b.range + displacement(b, a.position, axis) - a.range;
    const double across = displacement(b, a.position, axis + 0.5 * kPi);
    const double sd = parameters_.noise.sd(0.5 * (a.range + b.range));
    noise_scale_.add(difference, 2.0 * sd * sd, parallax_variance(across, half_angle));
  }
}

/// Each ping joins the nearest run that it fits: neighbours lie within half a cone (one or two silent pings may lie
/// between), a run within one full cone, for the echo's direction must lie in the cones of all its pings.
void DepthRegionFinder::group(double half_angle) {
  run_count_ = 0;
  const double scale = noise_scale_.value();
  for (std::size_t i = 0; i < pings_.size(); ++i) {
    const Ping& ping = pings_[i];
    Run* nearest = nullptr;
    double least = parameters_.threshold, range_there = 0.0;
    for (std::size_t k = 0; k < run_count_; ++k) {
      Run& run = runs_[k];
      if (ping.axis - run.last_axis > half_angle + kSameAngle) continue;
      if (ping.axis - run.first_axis > 2.0 * half_angle + kSameAngle) continue;
      const double axis = 0.5 * (run.first_axis + ping.axis);
      const double range = ping.range + displacement(ping, run.origin, axis);
      const double across = displacement(ping, run.origin, axis + 0.5 * kPi);
      const double sd = scale * parameters_.noise.sd(run.mean);
      const double variance =
          sd * sd * (1.0 + 1.0 / static_cast<double>(run.pings.size())) + parallax_variance(across, half_angle);
      const double distance = std::abs(range - run.mean) / std::sqrt(variance);
      if (distance > least) continue;
      least = distance;
      nearest = &run;
      range_there = range;
    }
    if (!nearest) {
      if (run_count_ == runs_.size()) runs_.emplace_back();
      nearest = &runs_[run_count_++];
      nearest->first_axis = ping.axis;
      nearest->origin = ping.position;
      nearest->mean = range_there = ping.range;
      nearest->pings.clear();
    }
    nearest->pings.push_back(static_cast<std::int32_t>(i));
    nearest->last_axis = ping.axis;
    nearest->mean += (range_there - nearest->mean) / static_cast<double>(nearest->pings.size());
  }
}

void DepthRegionFinder::summarise(const Run& run, double half_angle, DepthRegion& region) {
  const double n = static_cast<double>(run.pings.size());
  region = {};
  Sighting& heard = region.heard;
  double axis = 0.0;
  for (const std::int32_t i : run.pings) {
    const Ping& ping = pings_[static_cast<std::size_t>(i)];
    axis += ping.axis / n;
    heard.position += ping.position / n;
    region.beams.push_back(ping.beam);
  }
  // Huber's mean of the ranges moved to the mean position (95 % efficient for Gaussian noise), from the median.
  ranges_.clear();
  for (const std::int32_t i : run.pings) {
    const Ping& ping = pings_[static_cast<std::size_t>(i)];
    ranges_.push_back(ping.range + displacement(ping, heard.position, axis));
  }
  std::sort(ranges_.begin(), ranges_.end());
  heard.range = 0.5 * (ranges_[(ranges_.size() - 1) / 2] + ranges_[ranges_.size() / 2]);
  const double sd = noise_scale_.value() * parameters_.noise.sd(heard.range);
  for (int iteration = 0; iteration < 5; ++iteration) {
    double sum = 0.0, weights = 0.0;
    for (const double r : ranges_) {
      const double weight = std::min(1.0, 1.345 * sd / std::max(std::abs(r - heard.range), 1e-12));
      sum += weight * r;
      weights += weight;
    }
    heard.range = sum / weights;
  }
  heard.range_variance = sd * sd / n;
  heard.direction = wrap(axis);
  region.extent = run.last_axis - run.first_axis;
  // Pings answer with a probability that falls off like a Gaussian of sd half/2 about the echo's direction, and the
  // direction lies in the cones of all of them.
  const double profile = 0.5 * half_angle, room = std::max(half_angle - 0.5 * region.extent, radians(1.5));
  heard.direction_variance = 1.0 / (n / (profile * profile) + 3.0 / (room * room));
  const double step = run.pings.size() > 1 ? region.extent / (n - 1.0) : half_angle;
  heard.direction_bias_variance = std::pow(grid_bias(step, half_angle), 2);
}

}  // namespace noctule::sensors
