#pragma once
/// Executables that put a source on the bus.
#include "apps/common/command_line.hpp"
#include "modules/source_factory.hpp"

namespace noctule::apps {

/// Publishes everything, `speed` times as fast as it was measured (0: as fast as possible), until the end or Ctrl-C.
void run_source(bus::Bus& bus, modules::SourceModule& source, double speed);

}  // namespace noctule::apps
