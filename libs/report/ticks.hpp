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

/// `digit` times ten to the `exponent`.
struct LogTick {
  int digit = 1;
  int exponent = 0;
  friend bool operator==(const LogTick&, const LogTick&) = default;
};
/// Powers of ten within [low, high], both positive, about `count` of them; where there are fewer than three, their
/// multiples by 2 and 5 too, or by all digits.
[[nodiscard]] std::vector<LogTick> log_ticks(double low, double high, int count);

}  // namespace noctule::report
