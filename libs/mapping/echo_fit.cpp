#include "mapping/echo_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>
#include <vector>

namespace noctule::mapping {
namespace {

constexpr int kCoarse = 8;                 // iterations before the scale is estimated, at most
constexpr double kCoarsePrecision = 1e-4;  // [m, rad]
constexpr int kFine = 15;                  // and after
constexpr double kSmallestScale = 0.02;
constexpr double kLeastShare = 1e-3;  // of the information, as a determinant, that all stops but one must hold

/// Tukey's biweight: weight and derivative of the influence u (1 - u^2)^2, u being the residual over the cut.
struct Biweight {
  double weight;
  double slope;
};
Biweight biweight(double u) {
  const double v = 1.0 - u * u;
  if (v <= 0.0) return {0.0, 0.0};
  return {v * v, v * (1.0 - 5.0 * u * u)};
}

/// Solves for a step of the parameters the reflector has; the others stay 0.
std::optional<Vector3> solve(Matrix3 a, const Vector3& b, int dimension) {
  if (dimension == 2) a(2, 2) = 1.0;
  a.diagonal() *= 1.0 + 1e-9;
  const Eigen::LDLT<Matrix3> ldlt(a);
  if (ldlt.info() != Eigen::Success || !(ldlt.vectorD().minCoeff() > 1e-9 * ldlt.vectorD().maxCoeff())) return {};
  return ldlt.solve(b);
}

double median_scale(const Reflector& reflector, std::span<const SonarArc> arcs, std::span<const int> members,
                    double window_scale, const RobustParameters& parameters) {
  std::vector<double> residuals;
  residuals.reserve(members.size());
  for (const int i : members) {
    const SonarArc& arc = arcs[static_cast<std::size_t>(i)];
    const double e = std::abs(arc.range - reflector.sight(arc.sensor).range);
    if (e < std::max(parameters.tukey * window_scale * arc.sigma, parameters.floor)) residuals.push_back(e / arc.sigma);
  }
  if (residuals.empty()) return 1.0;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return std::clamp(1.4826 * *middle, kSmallestScale, parameters.max_scale);
}

/// One reweighted step; nothing when the normal matrix is singular.
template <class Cut>
std::optional<Vector3> step(const Reflector& reflector, std::span<const SonarArc> arcs, std::span<const int> members,
                            const Cut& cut) {
  Matrix3 a = Matrix3::Zero();
  Vector3 b = Vector3::Zero();
  for (const int i : members) {
    const SonarArc& arc = arcs[static_cast<std::size_t>(i)];
    const Reflector::Sight s = reflector.sight(arc.sensor);
    const double e = arc.range - s.range;
    const double c = cut(arc);
    if (std::abs(e) >= c) continue;
    const double w = biweight(e / c).weight / (arc.sigma * arc.sigma);
    const Vector3 j = reflector.gradient(arc.sensor, s), wj = w * j;
    for (int row = 0; row < 3; ++row) {  // the lower triangle
      for (int column = 0; column <= row; ++column) a(row, column) += wj[row] * j[column];
    }
    b += e * wj;
  }
  return solve(a, b, reflector.dimension());
}

}  // namespace

std::optional<EchoFit> fit_echoes(const EchoFit& start, std::span<const SonarArc> arcs, std::span<const int> members,
                                  const RobustParameters& parameters, double precision) {
  EchoFit fit = start;
  for (int i = 0; i < kCoarse; ++i) {
    const auto move = step(fit.reflector, arcs, members, [&](const SonarArc& arc) {
      return std::max(parameters.tukey * start.scale * arc.sigma, parameters.floor);
    });
    if (!move) return {};
    fit.reflector = fit.reflector.moved(*move);
    if (move->norm() < std::max(precision, kCoarsePrecision)) break;
  }
  fit.scale = median_scale(fit.reflector, arcs, members, start.scale, parameters);
  for (int i = 0; i < kFine; ++i) {
    const auto move = step(fit.reflector, arcs, members,
                           [&](const SonarArc& arc) { return parameters.tukey * fit.scale * arc.sigma; });
    if (!move) return {};
    fit.reflector = fit.reflector.moved(*move);
    if (i > 0 && move->norm() < precision) break;
    if (i == 0) fit.scale = median_scale(fit.reflector, arcs, members, fit.scale, parameters);
  }
  return fit;
}

EchoFit improved(const EchoFit& fit, std::span<const SonarArc> arcs, std::span<const int> members,
                 const RobustParameters& parameters) {
  const auto move =
      step(fit.reflector, arcs, members, [&](const SonarArc& arc) { return parameters.tukey * fit.scale * arc.sigma; });
  return move ? EchoFit{fit.reflector.moved(*move), fit.scale} : fit;
}

Matrix3 echo_covariance(const EchoFit& fit, std::span<const SonarArc> arcs, std::span<const int> members,
                        const RobustParameters& parameters) {
  struct Stop {
    int number;
    Matrix3 information = Matrix3::Zero();
    Vector3 score = Vector3::Zero();
  };
  std::vector<int> by_stop(members.begin(), members.end());
  const auto stop_of = [&](int i) { return arcs[static_cast<std::size_t>(i)].stop; };
  const auto earlier = [&](int a, int b) { return stop_of(a) < stop_of(b); };
  if (!std::is_sorted(by_stop.begin(), by_stop.end(), earlier))
    std::stable_sort(by_stop.begin(), by_stop.end(), earlier);
  std::vector<Stop> stops;
  Matrix3 information = Matrix3::Zero(), modelled = Matrix3::Zero();
  for (const int i : by_stop) {
    const SonarArc& arc = arcs[static_cast<std::size_t>(i)];
    if (stops.empty() || stops.back().number != arc.stop) stops.push_back({.number = arc.stop});
    const Reflector::Sight s = fit.reflector.sight(arc.sensor);
    const double e = arc.range - s.range, precision = 1.0 / (arc.sigma * arc.sigma);
    const auto [weight, slope] = biweight(e / (parameters.tukey * fit.scale * arc.sigma));
    const Vector3 j = fit.reflector.gradient(arc.sensor, s);
    stops.back().information += slope * precision * j * j.transpose();
    stops.back().score += weight * precision * e * j;
    modelled += weight * precision * j * j.transpose();
  }
  for (const Stop& stop : stops) information += stop.information;
  if (fit.reflector.dimension() == 2) information(2, 2) = modelled(2, 2) = 1.0;
  const Matrix3 inverse = information.inverse();
  Matrix3 scatter = Matrix3::Zero();
  for (const Stop& stop : stops) {
    const Matrix3 others = Matrix3::Identity() - stop.information * inverse;
    // Where one stop alone decides, the others cannot say by how much it errs: only the model of the noise can.
    if (!(others.determinant() > kLeastShare)) {
      Matrix3 covariance = fit.scale * fit.scale * modelled.inverse();
      if (fit.reflector.dimension() == 2) covariance(2, 2) = 0.0;
      return covariance;
    }
    const Vector3 d = others.inverse() * stop.score;
    scatter += d * d.transpose();
  }
  return inverse * scatter * inverse;
}

}  // namespace noctule::mapping
