#pragma once
/// Ultrasonic rangers in a room: which echo is heard, and how wrong the distance is.
#include <cstdint>
#include <vector>

#include "core/observations.hpp"
#include "sim/echo.hpp"
#include "sim/robot.hpp"

namespace noctule::sim {

class Sonar {
 public:
  /// Randomness is addressed by (seed, scan, beam) in one stream for hearing, one for noise and one for outliers: a
  /// changed sensor setting never shifts the numbers of another effect.
  Sonar(const SonarParameters&, const RoomGeometry&, std::uint64_t seed);

  /// The scan number `seq` from a base at rest; noise is `noise_factor` times the nominal. utime is left 0.
  [[nodiscard]] UltrasonicScan scan(const Pose2& base_in_map, std::int64_t seq, double noise_factor);

 private:
  struct Ping {
    std::int64_t scan;
    std::uint32_t beam;
    double noise_factor;
  };
  /// Range of the echo that is heard, 0 for none.
  [[nodiscard]] double listen(const Ping&, const Pose2& base_in_map);
  void measure(const Ping&, double range, UltrasonicBeam&) const;
  [[nodiscard]] double hit_probability(const EchoPath&) const;
  [[nodiscard]] double noise(const Ping&, double range) const;

  SonarParameters parameters_;
  EchoScene scene_;
  std::uint64_t seed_;
  std::vector<Pose2> sensors_in_base_;
  std::vector<EchoPath> echoes_;  // of one ping; kept to spare allocations
};

}  // namespace noctule::sim
