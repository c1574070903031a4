#include "eval/diversity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace noctule::eval {
namespace {

using Indices = std::vector<std::uint32_t>;

int count_distinct(Indices values) {
  std::ranges::sort(values);
  return static_cast<int>(std::ranges::unique(values).begin() - values.begin());
}

/// For each particle now, which particle of an earlier step it descends from.
Indices follow(const Indices& parents, const Indices& earlier) {
  Indices result(parents.size());
  for (std::size_t i = 0; i < parents.size(); ++i) result[i] = earlier[parents[i]];
  return result;
}

}  // namespace

std::vector<Diversity> diversity(std::span<const Indices> parents, int first_particles, int lag) {
  if (lag < 1) throw std::invalid_argument("diversity: lag must be >= 1");
  std::vector<Diversity> result;
  Indices founders(static_cast<std::size_t>(std::max(first_particles, 0)));
  std::iota(founders.begin(), founders.end(), 0u);
  for (std::size_t step = 0; step < parents.size(); ++step) {
    for (const std::uint32_t p : parents[step]) {
      if (p >= founders.size()) throw std::invalid_argument("diversity: a parent that does not exist");
    }
    founders = follow(parents[step], founders);
    Indices ancestors = parents[step];
    const std::size_t oldest = step + 1 > static_cast<std::size_t>(lag) ? step + 1 - static_cast<std::size_t>(lag) : 0;
    for (std::size_t back = step; back > oldest; --back) ancestors = follow(ancestors, parents[back - 1]);
    result.push_back({count_distinct(parents[step]), count_distinct(ancestors), count_distinct(founders)});
  }
  return result;
}

int distinct_poses(std::span<const WeightedPose> particles, double resolution) {
  std::vector<std::array<double, 3>> rounded;
  for (const WeightedPose& p : particles) {
    rounded.push_back(
        {std::round(p.pose.x / resolution), std::round(p.pose.y / resolution), std::round(p.pose.yaw / resolution)});
  }
  std::ranges::sort(rounded);
  return static_cast<int>(std::ranges::unique(rounded).begin() - rounded.begin());
}

double effective_sample_size(std::span<const WeightedPose> particles) {
  double sum = 0.0, squares = 0.0;
  for (const WeightedPose& p : particles) {
    sum += p.weight;
    squares += p.weight * p.weight;
  }
  const double size = sum * sum / squares;
  return std::isfinite(size) && sum > 0.0 ? size : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace noctule::eval
