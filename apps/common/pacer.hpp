#pragma once
#include <chrono>
#include <cstdint>
#include <optional>

namespace noctule::apps {

/// Holds back recorded or simulated time until the wall clock has caught up.
class Pacer {
 public:
  /// \param speed times real time; 0: no waiting
  explicit Pacer(double speed) : speed_(speed) {}

  /// Waits until what was measured at `utime` [us] is due, counted from the first call, or until Ctrl-C.
  void wait_for(std::int64_t utime);

 private:
  double speed_;
  std::optional<std::int64_t> first_;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace noctule::apps
