#include "sim/sonar.hpp"

#include <algorithm>
#include <cmath>

#include "core/rng.hpp"

namespace noctule::sim {
namespace {

constexpr std::uint64_t kHearing = stream_id("sonar.hearing");
constexpr std::uint64_t kNoise = stream_id("sonar.noise");
constexpr std::uint64_t kOutliers = stream_id("sonar.outliers");

double square(double x) {
  return x * x;
}

}  // namespace

Sonar::Sonar(const SonarParameters& parameters, const RoomGeometry& room, std::uint64_t seed)
    : parameters_(parameters), scene_(room), seed_(seed), sensors_in_base_(parameters.beams()) {
  const bool parallel = parameters_.firing == Firing::parallel;
  echoes_.reserve(scene_.size() * (parallel ? sensors_in_base_.size() : 1));
}

UltrasonicScan Sonar::scan(const Pose2& base_in_map, std::int64_t seq, double noise_factor) {
  UltrasonicScan scan;
  scan.stamp.seq = seq;
  scan.half_angle = parameters_.half_angle;
  scan.min_range = parameters_.min_range;
  scan.max_range = parameters_.max_range;
  scan.beams.resize(sensors_in_base_.size());
  for (std::uint32_t beam = 0; beam < scan.beams.size(); ++beam) {
    const Ping ping{seq, beam, noise_factor};
    scan.beams[beam].sensor_in_base = sensors_in_base_[beam];
    const double range = listen(ping, base_in_map);
    if (range > 0.0) measure(ping, range, scan.beams[beam]);
  }
  return scan;
}

double Sonar::listen(const Ping& ping, const Pose2& base_in_map) {
  const Pose2 receiver = base_in_map * sensors_in_base_[ping.beam];
  echoes_.clear();
  if (parameters_.firing == Firing::parallel) {
    for (const Pose2& emitter : sensors_in_base_) {
      scene_.find(base_in_map * emitter, receiver, parameters_.half_angle, echoes_);
    }
    std::ranges::sort(echoes_, {}, &EchoPath::range);
  } else {
    scene_.find(receiver, receiver, parameters_.half_angle, echoes_);
  }
  if (echoes_.empty()) return 0.0;
  Rng rng(seed_, kHearing, static_cast<std::uint64_t>(ping.scan), ping.beam);
  const auto heard =
      std::ranges::find_if(echoes_, [&](const EchoPath& echo) { return rng.uniform() < hit_probability(echo); });
  return heard == echoes_.end() ? 0.0 : heard->range;
}

double Sonar::hit_probability(const EchoPath& echo) const {
  const HitParameters& hit = parameters_.hit;
  // The beam patterns of emitter and receiver multiply; for a ranger that hears itself both angles are the same.
  const double off2 = 0.5 * (square(echo.emitted_off) + square(echo.received_off)) / square(parameters_.half_angle);
  const double fading = hit.fades_with_range ? 1.0 - square(square(echo.range / parameters_.max_range)) : 1.0;
  return (echo.diffracted ? hit.edge_peak : hit.peak) * std::exp(-hit.falloff * off2) * std::max(0.0, fading);
}

double Sonar::noise(const Ping& ping, double range) const {
  Rng rng(seed_, kNoise, static_cast<std::uint64_t>(ping.scan), ping.beam);
  const double normal = rng.normal();
  double factor = ping.noise_factor;
  double pick = rng.uniform();
  for (const NoiseComponent& c : parameters_.mixture) {
    pick -= c.weight;
    if (pick >= 0.0 && &c != &parameters_.mixture.back()) continue;
    factor *= c.factor;
    break;
  }
  return factor * parameters_.noise.sd(range) * normal;
}

void Sonar::measure(const Ping& ping, double range, UltrasonicBeam& beam) const {
  Rng outliers(seed_, kOutliers, static_cast<std::uint64_t>(ping.scan), ping.beam);
  if (outliers.uniform() < parameters_.outliers) {
    const bool crosstalk = outliers.uniform() < 0.5;
    range = crosstalk ? outliers.uniform(std::min(parameters_.min_range, range), range) : 2.0 * range;
  }
  double measured = range * (1.0 + parameters_.scale_error) + noise(ping, range);
  if (parameters_.quantisation > 0.0) {
    measured = parameters_.quantisation * std::round(measured / parameters_.quantisation);
  }
  if (measured > parameters_.max_range) return;  // later than the sensor waits
  if (measured < parameters_.min_range) {
    beam.echo = Echo::saturated;
    return;
  }
  beam.echo = Echo::hit;
  beam.range = measured;
}

}  // namespace noctule::sim
