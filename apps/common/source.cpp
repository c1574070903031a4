#include "apps/common/source.hpp"

#include <algorithm>
#include <chrono>
#include <thread>

#include "apps/common/interrupt.hpp"

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

void run_source(bus::Bus& bus, modules::SourceModule& source, double speed) {
  const auto begin = Clock::now();
  const auto first = source.next_utime();
  for (auto utime = first; utime && !interrupted(); utime = source.next_utime()) {
    if (speed > 0.0) {
      const std::chrono::duration<double> since_first(seconds(*utime - *first) / speed);
      sleep_until(begin + std::chrono::duration_cast<Clock::duration>(since_first));
    }
    if (!source.step()) break;
    bus.drain();
  }
  source.finish();
}

}  // namespace noctule::apps
