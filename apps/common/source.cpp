#include "apps/common/source.hpp"

#include "apps/common/interrupt.hpp"
#include "apps/common/pacer.hpp"

namespace noctule::apps {

void run_source(bus::Bus& bus, modules::SourceModule& source, double speed) {
  Pacer pacer(speed);
  for (auto utime = source.next_utime(); utime && !interrupted(); utime = source.next_utime()) {
    pacer.wait_for(*utime);
    if (!source.step()) break;
    bus.drain();
  }
  source.finish();
}

}  // namespace noctule::apps
