#pragma once
/// The order every ObservationSource promises, for sources that collect before they yield.
#include <algorithm>
#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "core/source.hpp"

namespace noctule {

/// The stamp of whatever kind of observation it is.
[[nodiscard]] inline Stamp& stamp_of(Observation& observation) {
  return std::visit([](auto& value) -> Stamp& { return value.stamp; }, observation);
}
[[nodiscard]] inline const Stamp& stamp_of(const Observation& observation) {
  return std::visit([](const auto& value) -> const Stamp& { return value.stamp; }, observation);
}

/// Sorts by utime (at equal times: odometry, ground truth, then sightings; else as they came) and numbers each kind
/// from 0.
inline void put_in_order(std::vector<Observation>& observations) {
  const auto rank = [](const Observation& o) {
    return std::holds_alternative<Odometry>(o) ? 0 : std::holds_alternative<GroundTruth>(o) ? 1 : 2;
  };
  std::stable_sort(observations.begin(), observations.end(), [&](const Observation& a, const Observation& b) {
    const std::int64_t ta = stamp_of(a).utime, tb = stamp_of(b).utime;
    return ta != tb ? ta < tb : rank(a) < rank(b);
  });
  std::array<std::int64_t, std::variant_size_v<Observation>> count{};
  for (Observation& o : observations) stamp_of(o).seq = count[o.index()]++;
}

}  // namespace noctule
