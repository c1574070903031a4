#pragma once

namespace noctule::apps {

/// From now on Ctrl-C and SIGTERM ask the program to end instead of ending it; a second one ends it at once.
void catch_interrupts();
[[nodiscard]] bool interrupted();

}  // namespace noctule::apps
