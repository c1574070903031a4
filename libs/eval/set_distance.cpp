#include "eval/set_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/assignment.hpp"

namespace noctule::eval {
namespace {

void check(const Eigen::MatrixXd& distances, const SetDistanceParameters& p) {
  if (!(p.order >= 1.0 && std::isfinite(p.order))) {
    throw std::invalid_argument("set distance: order must be a number >= 1");
  }
  if (!(p.cutoff > 0.0 && std::isfinite(p.cutoff))) throw std::invalid_argument("set distance: cut-off must be > 0");
  if (!(distances.array() >= 0.0).all()) throw std::invalid_argument("set distance: a distance is NaN or negative");
}

/// Pairs nearer than the cut-off that together cost least, everything else costing c^p.
struct Pairs {
  int count = 0;
  double sum = 0.0;  ///< of (d / c)^p: no overflow, whatever the unit
};

/// In units of the cut-off, one assignment serves all three distances: a pair at the cut-off or beyond costs what two
/// singles cost.
Pairs assign_within_cutoff(const Eigen::MatrixXd& distances, const SetDistanceParameters& p) {
  const Eigen::MatrixXd cost = (distances.array() / p.cutoff).min(1.0).pow(p.order).matrix();
  Pairs pairs;
  const std::vector<int> column = assign(cost, 1.0);
  for (std::size_t row = 0; row < column.size(); ++row) {
    if (column[row] < 0) continue;
    const double c = cost(static_cast<Eigen::Index>(row), column[row]);
    if (c >= 1.0) continue;
    ++pairs.count;
    pairs.sum += c;
  }
  return pairs;
}

}  // namespace

Eigen::MatrixXd distances(std::span<const Vector2> estimates, std::span<const Vector2> truth) {
  Eigen::MatrixXd d(estimates.size(), truth.size());
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    for (std::size_t j = 0; j < truth.size(); ++j) d(i, j) = (estimates[i] - truth[j]).norm();
  }
  return d;
}

Ospa ospa(const Eigen::MatrixXd& distances, const SetDistanceParameters& p) {
  check(distances, p);
  const auto small = static_cast<double>(std::min(distances.rows(), distances.cols()));
  const auto large = static_cast<double>(std::max(distances.rows(), distances.cols()));
  if (large == 0.0) return {};
  const Pairs pairs = assign_within_cutoff(distances, p);
  const double localisation = (pairs.sum + (small - pairs.count)) / large;  // pairs beyond the cut-off cost c
  const double cardinality = (large - small) / large;
  const auto length = [&](double power) { return p.cutoff * std::pow(power, 1.0 / p.order); };
  return {length(localisation + cardinality), length(localisation), length(cardinality)};
}

Gospa gospa(const Eigen::MatrixXd& distances, const SetDistanceParameters& p) {
  check(distances, p);
  const Pairs pairs = assign_within_cutoff(distances, p);
  Gospa g;
  g.assigned_count = pairs.count;
  g.missed_count = static_cast<int>(distances.cols()) - pairs.count;
  g.false_count = static_cast<int>(distances.rows()) - pairs.count;
  const auto length = [&](double power) { return p.cutoff * std::pow(power, 1.0 / p.order); };
  g.localisation = length(pairs.sum);
  g.missed = length(0.5 * g.missed_count);
  g.false_alarms = length(0.5 * g.false_count);
  g.total = length(pairs.sum + 0.5 * (g.missed_count + g.false_count));
  return g;
}

double cola(const Eigen::MatrixXd& distances, const SetDistanceParameters& p) {
  check(distances, p);
  const auto large = static_cast<double>(std::max(distances.rows(), distances.cols()));
  const Pairs pairs = assign_within_cutoff(distances, p);
  return std::pow(pairs.sum + (large - pairs.count), 1.0 / p.order);
}

Ospa ospa(std::span<const Vector2> estimates, std::span<const Vector2> truth, const SetDistanceParameters& p) {
  return ospa(distances(estimates, truth), p);
}
Gospa gospa(std::span<const Vector2> estimates, std::span<const Vector2> truth, const SetDistanceParameters& p) {
  return gospa(distances(estimates, truth), p);
}
double cola(std::span<const Vector2> estimates, std::span<const Vector2> truth, const SetDistanceParameters& p) {
  return cola(distances(estimates, truth), p);
}

}  // namespace noctule::eval
