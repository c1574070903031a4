#include "particle/alias_table.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>

namespace noctule::particle {

void AliasTable::assign(std::span<const double> weights) {
  double total = 0.0;
  for (const double w : weights) {
    if (!(w >= 0.0) || !std::isfinite(w)) throw std::invalid_argument("alias table: weights must be finite and >= 0");
    total += w;
  }
  if (!(total > 0.0) || !std::isfinite(total))
    throw std::invalid_argument("alias table: weights need a finite sum > 0");
  const auto n = static_cast<double>(weights.size());
  probability_.resize(weights.size());
  keep_.resize(weights.size());
  alias_.resize(weights.size());
  std::iota(alias_.begin(), alias_.end(), 0u);
  small_.clear();
  large_.clear();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    probability_[i] = weights[i] / total;
    keep_[i] = probability_[i] * n;
    (keep_[i] < 1.0 ? small_ : large_).push_back(static_cast<std::uint32_t>(i));
  }
  while (!small_.empty() && !large_.empty()) {
    const std::uint32_t poor = small_.back(), rich = large_.back();
    small_.pop_back();
    alias_[poor] = rich;
    keep_[rich] -= 1.0 - keep_[poor];
    if (keep_[rich] < 1.0) {
      large_.pop_back();
      small_.push_back(rich);
    }
  }
  for (const std::uint32_t i : large_) keep_[i] = 1.0;  // what rounding left over
  for (const std::uint32_t i : small_) keep_[i] = 1.0;
}

}  // namespace noctule::particle
