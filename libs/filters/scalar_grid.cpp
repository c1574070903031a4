#include "filters/scalar_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace noctule::filters {

ScalarGrid::ScalarGrid(double low, double high, std::size_t points)
    : spacing_((high - low) / static_cast<double>(points - 1)), points_(points), masses_(points) {
  if (!(low < high) || points < 2) throw std::invalid_argument("scalar grid: low < high and two points are needed");
  for (std::size_t i = 0; i < points; ++i) points_[i] = low + static_cast<double>(i) * spacing_;
  std::ranges::fill(masses_, 1.0 / static_cast<double>(points));
}

double ScalarGrid::mean() const {
  return std::inner_product(points_.begin(), points_.end(), masses_.begin(), 0.0);
}

void ScalarGrid::set_normal(double mean, double sd) {
  std::ranges::transform(points_, masses_.begin(),
                         [&](double x) { return std::exp(-0.5 * (x - mean) * (x - mean) / (sd * sd)); });
  normalise();
}

void ScalarGrid::predict(std::span<const double> images, double sd) {
  // Mass between two points is shared by both, which adds a sixth of a squared spacing to the variance.
  moved_.assign(points_.size(), 0.0);
  const double last = static_cast<double>(points_.size() - 1);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const double at = std::clamp((images[i] - points_.front()) / spacing_, 0.0, last);
    const auto below = std::min(static_cast<std::size_t>(at), points_.size() - 2);
    const double share = at - static_cast<double>(below);
    moved_[below] += (1.0 - share) * masses_[i];
    moved_[below + 1] += share * masses_[i];
  }
  const double variance = sd * sd / (spacing_ * spacing_) - 1.0 / 6.0;
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(7.0 * std::sqrt(variance)));
  kernel_.resize(static_cast<std::size_t>(2 * reach + 1));
  for (std::ptrdiff_t k = -reach; k <= reach; ++k) {
    kernel_[static_cast<std::size_t>(k + reach)] = std::exp(-0.5 * static_cast<double>(k * k) / variance);
  }
  std::ranges::fill(masses_, 0.0);
  const auto n = static_cast<std::ptrdiff_t>(points_.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const double mass = moved_[static_cast<std::size_t>(i)];
    if (mass < 1e-20) continue;
    const std::ptrdiff_t begin = std::max(i - reach, std::ptrdiff_t{0}), end = std::min(i + reach + 1, n);
    double* const out = masses_.data();
    const double* const kernel = kernel_.data() + (reach - i);
    for (std::ptrdiff_t j = begin; j < end; ++j) out[j] += mass * kernel[j];
  }
  normalise();
}

void ScalarGrid::update(std::span<const double> log_likelihoods) {
  const double largest = *std::ranges::max_element(log_likelihoods);
  moved_ = masses_;
  for (std::size_t i = 0; i < masses_.size(); ++i) masses_[i] *= std::exp(log_likelihoods[i] - largest);
  if (std::accumulate(masses_.begin(), masses_.end(), 0.0) > 0.0) {
    normalise();
  } else {
    masses_ = moved_;
  }
}

void ScalarGrid::normalise() {
  const double total = std::accumulate(masses_.begin(), masses_.end(), 0.0);
  for (double& m : masses_) m /= total;
}

}  // namespace noctule::filters
