#pragma once
/// Draws from a discrete distribution in constant time (Walker 1977, tables as by Vose 1991).
#include <cstdint>
#include <span>
#include <vector>

#include "core/rng.hpp"

namespace noctule::particle {

class AliasTable {
 public:
  /// Takes another distribution; allocates only for more weights than ever before.
  /// \param weights not necessarily normalised \throws std::invalid_argument when one is NaN, infinite or negative, all
  /// are 0, or there are none
  void assign(std::span<const double> weights);

  /// Number of weights.
  [[nodiscard]] std::size_t size() const { return probability_.size(); }
  /// Of drawing i.
  [[nodiscard]] double probability(std::size_t i) const { return probability_[i]; }
  /// An index below size(), which must not be 0.
  [[nodiscard]] std::size_t draw(Rng& rng) const {
    const double u = rng.uniform() * static_cast<double>(size());
    const auto i = static_cast<std::size_t>(u);
    return u - static_cast<double>(i) < keep_[i] ? i : alias_[i];
  }

 private:
  std::vector<double> probability_, keep_;
  std::vector<std::uint32_t> alias_, small_, large_;  ///< the latter two: scratch
};

}  // namespace noctule::particle
