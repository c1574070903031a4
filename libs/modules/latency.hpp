#pragma once
/// Durations of a handler by the wall clock.
#include <array>
#include <cstdint>

namespace noctule::modules {

/// Histogram over a logarithmic scale: bounded memory for any number of durations, percentiles within 3 %.
class LatencyHistogram {
 public:
  void add(double seconds);
  void clear() { *this = {}; }

  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] double sum() const { return sum_; }  ///< [s]
  [[nodiscard]] double max() const { return max_; }  ///< [s]
  /// Duration that this fraction of all does not exceed [s]; 0 when there are none.
  [[nodiscard]] double percentile(double fraction) const;

 private:
  static constexpr double kLeast = 1e-8;  ///< [s]
  static constexpr int kPerDecade = 80;
  static constexpr int kDecades = 11;

  std::array<std::int64_t, kPerDecade * kDecades> bins_{};
  std::int64_t count_ = 0;
  double sum_ = 0.0;
  double max_ = 0.0;
};

}  // namespace noctule::modules
