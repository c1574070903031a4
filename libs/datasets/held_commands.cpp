#include "datasets/held_commands.hpp"

#include <algorithm>

#include "datasets/arc.hpp"

namespace noctule::datasets {

Pose2 held(const Command& command, double duration) {
  return arc(command.speed * duration, command.turn_rate * duration);
}

std::vector<Odometry> integrate(std::span<const Command> commands, std::span<const std::int64_t> stops,
                                const models::OdometryRandomWalk& noise) {
  std::vector<std::int64_t> utimes(stops.begin(), stops.end());
  for (const Command& c : commands) utimes.push_back(c.utime);
  std::sort(utimes.begin(), utimes.end());
  utimes.erase(std::unique(utimes.begin(), utimes.end()), utimes.end());
  std::vector<Odometry> odometry;
  std::size_t now = 0;  // the last command at or before the beginning of the increment
  for (std::size_t i = 1; i < utimes.size(); ++i) {
    while (now + 1 < commands.size() && commands[now + 1].utime <= utimes[i - 1]) ++now;
    const Pose2 increment = held(commands[now], seconds(utimes[i] - utimes[i - 1]));
    odometry.push_back({{utimes[i], 0}, increment, noise.covariance(increment)});
  }
  return odometry;
}

}  // namespace noctule::datasets
