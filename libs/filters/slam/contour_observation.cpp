#include "filters/slam/contour_observation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/limits.hpp"

namespace noctule::filters {
namespace {

/// Squared residuals, in units of the nominal variance, from which on a learned noise makes an echo less likely than a
/// given log density: looked up in steps of 30 %, for solving it exactly for each echo costs more than it saves.
class LearnedGates {
 public:
  explicit LearnedGates(const models::NoiseMixture<1>& noise) {
    double gate2 = 4.0;
    for (std::size_t k = 0; k < kSteps; ++k, gate2 *= 1.3) {
      gate2_[k] = gate2;
      log_density_[k] = noise.log_density_bound(gate2);
    }
  }
  [[nodiscard]] double operator()(double log_density) const {
    for (std::size_t k = 0; k < kSteps; ++k) {
      if (log_density_[k] <= log_density) return gate2_[k];
    }
    return kInf;
  }

 private:
  static constexpr std::size_t kSteps = 32;
  std::array<double, kSteps> gate2_, log_density_;
};

void note_residual(const AssimilatedEcho& a, std::size_t echo, std::span<EchoResidual> residuals) {
  if (residuals.empty()) return;
  residuals[echo] = {a.residual.mean[0], a.residual.second_moment(0, 0), a.noise};
}

}  // namespace

ContourObservation::ContourObservation(const UltrasonicScan& scan, const ContourFeatures& features, int stop,
                                       std::int64_t first_id, const ParticleSlamParameters& parameters,
                                       const models::NoiseMixture<1>* noise)
    : parameters_(parameters), noise_(noise), stop_(stop), log_clutter_(parameters.echo.log_clutter()) {
  const double bearing_sd = parameters.echo.bearing_sd_per_half_angle * scan.half_angle;
  bearing_variance_ = bearing_sd * bearing_sd;
  gate_cosine_ = std::cos(std::min(4.0 * bearing_sd, kPi));

  std::optional<LearnedGates> gates;
  if (noise != nullptr) gates.emplace(*noise);
  constexpr std::size_t no_echo = ~std::size_t{0};
  std::vector<std::size_t> ping_of_beam(scan.beams.size(), no_echo);
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    const UltrasonicBeam& beam = scan.beams[i];
    if (beam.echo != Echo::hit) continue;
    const double sd = parameters.echo.range_noise.sd(beam.range);
    ping_of_beam[i] = pings_.size();
    const Pose2& sensor = beam.sensor_in_base;
    // Of all landmarks, one that is known exactly has the highest density at a given normalised innovation.
    const double log_top = -std::log(kTwoPi * sd * bearing_sd);
    pings_.push_back({.sensor_in_base = sensor.position(),
                      .axis = {std::cos(sensor.yaw), std::sin(sensor.yaw)},
                      .range = beam.range,
                      .range_variance = sd * sd,
                      .gate2 = gates ? (*gates)(log_clutter_ + std::log(sd * bearing_sd) + 0.5 * std::log(kTwoPi))
                                     : 2.0 * (log_top - log_clutter_)});
  }
  for (std::size_t k = 0; k < features.features.size(); ++k) {
    const ContourFeature& feature = features.features[k];
    Start start{&feature, {}, first_id - static_cast<std::int64_t>(k)};
    for (const ReadingId& reading : feature.readings) {
      if (reading.scan_seq != scan.stamp.seq) continue;
      const std::size_t ping = ping_of_beam[static_cast<std::size_t>(reading.beam)];
      if (ping != no_echo) start.pings.push_back(ping);
    }
    if (!start.pings.empty()) starts_.push_back(std::move(start));
  }
}

ContourObservation::Frame::Frame(const Pose2& pose) : base(pose) {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  rotation << c, -s, s, c;
}

PlacedEcho ContourObservation::place(const Frame& frame, const Ping& ping) const {
  return {.sensor = frame.base.position() + frame.rotation * ping.sensor_in_base,
          .axis = frame.rotation * ping.axis,
          .gate_cosine = gate_cosine_,
          .range = ping.range,
          .range_variance = ping.range_variance,
          .bearing_variance = bearing_variance_,
          .gate2 = ping.gate2,
          .noise = noise_};
}

ObservationFit ContourObservation::apply(const Pose2& base, std::vector<ContourLandmark>& map,
                                         std::vector<char>& explained, std::span<EchoResidual> residuals) const {
  std::erase_if(map, [&](const ContourLandmark& l) { return l.failed(stop_, parameters_.contour_landmarks); });
  explained.assign(pings_.size(), 0);
  std::ranges::fill(residuals, EchoResidual{});
  const Frame frame(base);
  ObservationFit fit;
  for (std::size_t i = 0; i < pings_.size(); ++i) {
    const PlacedEcho echo = place(frame, pings_[i]);
    ContourLandmark* best = nullptr;
    double log_likelihood = log_clutter_;
    for (ContourLandmark& landmark : map) {
      const double candidate = landmark.log_likelihood(echo);
      if (candidate <= log_likelihood) continue;
      log_likelihood = candidate;
      best = &landmark;
    }
    fit.log_likelihood += log_likelihood;
    if (best == nullptr) continue;
    explained[i] = 1;
    const AssimilatedEcho a = best->assimilate(echo, log_clutter_, stop_, parameters_.contour_landmarks);
    fit.nis += a.nis;
    fit.degrees_of_freedom += 2;
    note_residual(a, i, residuals);
  }
  start_landmarks(frame, map, explained, residuals);
  return fit;
}

bool ContourObservation::is_known(const ContourFeature& feature, const Frame& frame,
                                  const std::vector<ContourLandmark>& map) const {
  const double range = std::max(feature.surface.norm(), 1e-3);
  const PlacedEcho echo = place(frame, {.sensor_in_base = Vector2::Zero(),
                                        .axis = feature.surface / range,
                                        .range = range,
                                        .range_variance = 0.0,
                                        .gate2 = 0.0});
  const double separation = parameters_.contour_landmarks.separation;
  return std::ranges::any_of(map, [&](const ContourLandmark& l) { return l.expects_near(echo, separation); });
}

void ContourObservation::start_landmarks(const Frame& frame, std::vector<ContourLandmark>& map,
                                         std::vector<char>& explained, std::span<EchoResidual> residuals) const {
  for (const Start& start : starts_) {
    const auto unexplained = std::ranges::count_if(start.pings, [&](std::size_t i) { return explained[i] == 0; });
    if (2 * static_cast<std::size_t>(unexplained) <= start.pings.size()) continue;
    if (is_known(*start.feature, frame, map)) continue;
    ContourLandmark landmark(*start.feature, frame.base, start.id, stop_, parameters_.contour_landmarks);
    for (const std::size_t i : start.pings) {
      if (explained[i] != 0) continue;
      const PlacedEcho echo = place(frame, pings_[i]);
      if (landmark.log_likelihood(echo) <= log_clutter_) continue;
      note_residual(landmark.assimilate(echo, log_clutter_, stop_, parameters_.contour_landmarks), i, residuals);
      explained[i] = 1;
    }
    map.push_back(landmark);
  }
}

}  // namespace noctule::filters
