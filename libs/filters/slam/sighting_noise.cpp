#include "filters/slam/sighting_noise.hpp"

#include <algorithm>

#include "core/pose2.hpp"

namespace noctule::filters {
namespace {

/// L C L' where `whitening` is the inverse of L.
SightingCovariance in_units(const Whitening& w, const Matrix2& c) {
  const double l_rr = 1.0 / w.rr, l_bb = 1.0 / w.bb, l_br = -w.br * l_rr * l_bb;
  const double across = l_br * c(0, 0) + l_bb * c(0, 1);
  return {l_rr * l_rr * c(0, 0), l_rr * across, l_br * (across + l_bb * c(0, 1)) + l_bb * l_bb * c(1, 1)};
}

Vector2 whitened(const Whitening& w, double range, double bearing) {
  return {w.rr * range, w.br * range + w.bb * bearing};
}

Matrix2 whitened(const Whitening& w, const SightingCovariance& p) {
  const double rr = w.rr * p.rr, rb = w.rr * p.rb;
  Matrix2 result;
  result(0, 0) = w.rr * rr;
  result(0, 1) = result(1, 0) = w.br * rr + w.bb * rb;
  result(1, 1) = w.br * (w.br * p.rr + 2.0 * w.bb * p.rb) + w.bb * w.bb * p.bb;
  return result;
}

}  // namespace

void SightingNoise::begin(std::span<Sighting> sightings) {
  if (!learns()) return;
  model_.begin(static_cast<std::size_t>(std::ranges::count_if(sightings, &Sighting::is_whole)));
  width_ = sightings.size();
  residuals_.assign(width_ * particles_, {});
  const Matrix2 believed = model_.mixture().effective(Vector2::Zero()).covariance;
  for (Sighting& z : sightings) {
    if (!z.is_whole()) continue;
    const double root = std::sqrt(z.rr), skew = z.rb / root;
    z.stated.rr = 1.0 / root;
    z.stated.bb = 1.0 / std::sqrt(z.bb - skew * skew);
    z.stated.br = -skew * z.stated.rr * z.stated.bb;
    const SightingCovariance noise = in_units(z.stated, believed);
    z.rr = noise.rr;
    z.rb = noise.rb;
    z.bb = noise.bb;
  }
}

SightingNoise::Judgement SightingNoise::judge(const Sighting& z, const Innovation& v,
                                              const SightingCovariance& expected) const {
  const Whitening& w = z.stated;
  const Vector2 residual = whitened(w, v.range, v.bearing);
  const Matrix2 extra = whitened(w, expected);
  const auto judged = model_.mixture().judge(residual, extra);
  const SightingCovariance noise = in_units(w, judged.effective.covariance);
  const Vector2& bias = judged.effective.bias;
  const double l_rr = 1.0 / w.rr, l_bb = 1.0 / w.bb;
  const Matrix2 stated = Matrix2::Identity() + extra;
  const double nis = (residual.x() * (stated(1, 1) * residual.x() - stated(0, 1) * residual.y()) +
                      residual.y() * (stated(0, 0) * residual.y() - stated(0, 1) * residual.x())) /
                     models::small_determinant<2>(stated);
  return {judged.log_density + std::log(w.rr * w.bb), l_rr * bias.x(), l_bb * (bias.y() - w.br * l_rr * bias.x()),
          noise, nis};
}

void SightingNoise::note(const ParticleView& view, const Pose2& pose, std::size_t known) {
  const Pose2 sensor = sensor_pose(pose, view.scan.sensor_in_base);
  for (std::size_t k = 0; k < view.slots.size(); ++k) {
    if (!view.is_known(k, known) || !view.scan.sightings[k].is_whole()) continue;
    const Sighting& z = view.scan.sightings[k];
    const PointLandmark& m = view.landmark(k);
    const Innovation v = innovation<double>(z, sensor, m.x, m.y);
    const auto c = cross_covariance<double>(m, v);
    const Vector2 e = whitened(z.stated, v.range, v.bearing);
    const Matrix2 p = whitened(z.stated, {v.ux * c.xr + v.uy * c.yr, v.ux * c.xb + v.uy * c.yb,
                                          v.inverse_range * (v.ux * c.yb - v.uy * c.xb)});
    if (!e.allFinite() || !p.allFinite()) continue;
    residuals_[view.particle * width_ + k] = {
        true, e.x(), e.y(), e.x() * e.x() + p(0, 0), e.x() * e.y() + p(0, 1), e.y() * e.y() + p(1, 1)};
  }
}

void SightingNoise::learn(std::span<const double> weights) {
  learned_.clear();
  for (std::size_t k = 0; k < width_; ++k) {
    NoiseResidual<2> sum{.weight = 0.0};
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const Residual& r = residuals_[i * width_ + k];
      if (!r.used) continue;
      sum.weight += weights[i];
      sum.mean += weights[i] * Vector2(r.range, r.bearing);
      sum.second_moment(0, 0) += weights[i] * r.rr;
      sum.second_moment(0, 1) += weights[i] * r.rb;
      sum.second_moment(1, 1) += weights[i] * r.bb;
    }
    if (sum.weight < 1e-6) continue;
    sum.mean /= sum.weight;
    sum.second_moment(1, 0) = sum.second_moment(0, 1);
    sum.second_moment /= sum.weight;
    learned_.push_back(sum);
  }
  if (learned_.empty()) return;
  model_.learn(learned_);
  double variance = 0.0;
  for (const NoiseResidual<2>& r : learned_) variance += 0.5 * model_.mixture().effective(r.mean).covariance.trace();
  scale_ = std::sqrt(variance / static_cast<double>(learned_.size()));
}

}  // namespace noctule::filters
