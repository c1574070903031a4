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

/// Exponents of powers of ten within [low, high], both positive; about `count` of them.
[[nodiscard]] std::vector<int> log_ticks(double low, double high, int count);

}  // namespace noctule::report
