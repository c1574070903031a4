#include "apps/common/pacer.hpp"

#include <algorithm>
#include <thread>

#include "apps/common/interrupt.hpp"
#include "core/stamp.hpp"

namespace noctule::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// In pieces: a signal does not end a sleep.
void sleep_until(Clock::time_point due) {
  constexpr std::chrono::milliseconds kPiece{50};
  for (auto now = Clock::now(); now < due && !interrupted(); now = Clock::now()) {
    std::this_thread::sleep_for(std::min<Clock::duration>(kPiece, due - now));
  }
}

}  // namespace

void Pacer::wait_for(std::int64_t utime) {
  if (!(speed_ > 0.0)) return;
  if (!first_) {
    first_ = utime;
    begin_ = Clock::now();
  }
  const std::chrono::duration<double> since_first(seconds(utime - *first_) / speed_);
  sleep_until(begin_ + std::chrono::duration_cast<Clock::duration>(since_first));
}

}  // namespace noctule::apps
