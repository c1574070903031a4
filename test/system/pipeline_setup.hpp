#pragma once
/// A short run of the heptagon room, and what tests look at in it.
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "system/process.hpp"

namespace noctule::system_test {

inline const std::string kSource = NOCTULE_SOURCE_DIR;
inline const std::string kBin = NOCTULE_BIN_DIR;
inline const std::string kHeptagon = kSource + "/config/pipelines/heptagon.yaml";

/// The pipeline file and overriding values that make it short: one loop, few particles.
[[nodiscard]] inline std::vector<std::string> short_run() {
  return {kHeptagon, "--seed", "7", "--set", "source.world.path.loops=1", "--set", "slam.filter.particles=20"};
}

[[nodiscard]] inline std::vector<std::string> command(const std::string& app, std::vector<std::string> arguments,
                                                      const std::vector<std::string>& more = {}) {
  arguments.insert(arguments.begin(), kBin + "/" + app);
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// All messages of a channel in a log.
template <bus::Message M>
[[nodiscard]] std::vector<M> messages_in(const fs::path& log, const std::string& channel) {
  std::vector<M> all;
  bus::LogReader reader(log);
  while (const auto event = reader.next()) {
    if (event->channel == channel) all.push_back(bus::decode<M>(event->data));
  }
  return all;
}

}  // namespace noctule::system_test
