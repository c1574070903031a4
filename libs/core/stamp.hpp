#pragma once
#include <cstdint>

namespace noctule {

/// When a value was measured and which one of its channel it is.
struct Stamp {
  std::int64_t utime = 0;  ///< microseconds, when measured (not when sent)
  std::int64_t seq = 0;    ///< number on its channel, from 0, without gaps
  friend bool operator==(const Stamp&, const Stamp&) = default;
};

[[nodiscard]] constexpr double seconds(std::int64_t utime) {
  return 1e-6 * static_cast<double>(utime);
}

}  // namespace noctule
