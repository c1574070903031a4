#pragma once
#include "bus/codec.hpp"
#include "noctule/module_status.hpp"
#include "noctule/odometry.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::bus {

inline odometry make_odometry(std::int64_t seq, double dx = 0.25) {
  odometry m{};
  m.utime = 1000 * seq;
  m.seq = seq;
  m.frame = "base_link";
  m.dx_m = dx;
  return m;
}

inline ultrasonic_scan make_scan(std::int64_t seq, int beams) {
  ultrasonic_scan m{};
  m.utime = 1000 * seq;
  m.seq = seq;
  m.frame = "base_link";
  m.beam_count = beams;
  m.beams.resize(static_cast<std::size_t>(beams));
  for (int i = 0; i < beams; ++i) m.beams[static_cast<std::size_t>(i)] = {0.1, 0.0, 0.105 * i, 1.0 + i, 0};
  return m;
}

template <Message M>
std::vector<std::uint8_t> bytes_of(const M& message) {
  std::vector<std::uint8_t> bytes;
  encode(message, bytes);
  return bytes;
}

}  // namespace noctule::bus
