#pragma once
#include <vector>

namespace noctule::report {

/// 1, 2 or 5 times a power of ten, the smallest not below `rough` (positive).
[[nodiscard]] double nice_step(double rough);

/// Multiples of a nice step within [low, high], about `count` of them.
struct Ticks {
  std::vector<double> values;
  int decimals = 0;  ///< that tell neighbours apart
};
[[nodiscard]] Ticks linear_ticks(double low, double high, int count);

/// Powers of ten within [low, high], both positive.
[[nodiscard]] Ticks log_ticks(double low, double high);

}  // namespace noctule::report
