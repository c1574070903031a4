#pragma once
#include <string>
#include <vector>

#include "bus/bus.hpp"

namespace noctule::modules {

/// Everything that was published on a channel.
template <bus::Message M>
class Heard {
 public:
  Heard(bus::Bus& bus, const std::string& channel) {
    bus.subscribe<M>(channel, [this](const M& message) { all.push_back(message); });
  }
  std::vector<M> all;
};

}  // namespace noctule::modules
