/// Cost of a message over `memq://`, publish and drain: raw LCM with bytes, raw LCM with the generated type, the bus
/// (which adds strict decoding and the sequence check), and the bus with conversion and its checks on both sides. The
/// argument is the number of beams of an ultrasonic scan.
#include <benchmark/benchmark.h>
#include <lcm/lcm-cpp.hpp>

#include "bus/bus.hpp"
#include "convert/convert.hpp"

namespace noctule {
namespace {

constexpr const char* kChannel = "ULTRASONIC_SCAN";

UltrasonicScan make_scan(const benchmark::State& state) {
  UltrasonicScan scan;
  scan.half_angle = 0.26;
  scan.max_range = 4.0;
  for (int i = 0; i < state.range(0); ++i) scan.beams.push_back({{0.1, 0.0, 0.1 * i}, 1.0 + 0.01 * i, Echo::hit});
  return scan;
}

void set_counters(benchmark::State& state) {
  state.counters["bytes"] = convert::to_message(make_scan(state)).getEncodedSize();
}

void drain(lcm::LCM& lcm) {
  while (lcm.handleTimeout(0) > 0) {
  }
}

void raw_lcm_bytes(benchmark::State& state) {
  lcm::LCM lcm("memq://");
  std::size_t received = 0;
  const auto receive =
      +[](const lcm::ReceiveBuffer* buffer, const std::string&, std::size_t* sum) { *sum += buffer->data_size; };
  lcm.subscribeFunction(kChannel, receive, &received);
  std::vector<std::uint8_t> bytes;
  bus::encode(convert::to_message(make_scan(state)), bytes);
  for (auto _ : state) {
    lcm.publish(kChannel, bytes.data(), static_cast<unsigned>(bytes.size()));
    drain(lcm);
  }
  benchmark::DoNotOptimize(received);
  set_counters(state);
}
BENCHMARK(raw_lcm_bytes)->Arg(0)->Arg(60);

void raw_lcm_message(benchmark::State& state) {
  lcm::LCM lcm("memq://");
  std::int64_t received = 0;
  const auto receive = +[](const lcm::ReceiveBuffer*, const std::string&, const ultrasonic_scan* m, std::int64_t* sum) {
    *sum += m->beam_count;
  };
  lcm.subscribeFunction(kChannel, receive, &received);
  const auto message = convert::to_message(make_scan(state));
  for (auto _ : state) {
    lcm.publish(kChannel, &message);
    drain(lcm);
  }
  benchmark::DoNotOptimize(received);
  set_counters(state);
}
BENCHMARK(raw_lcm_message)->Arg(0)->Arg(60);

void bus_message(benchmark::State& state) {
  bus::Bus bus;
  std::int64_t received = 0;
  bus.subscribe<ultrasonic_scan>(kChannel, [&](const ultrasonic_scan& m) { received += m.beam_count; });
  auto message = convert::to_message(make_scan(state));
  for (auto _ : state) {
    bus.publish(kChannel, message);
    bus.drain();
    ++message.seq;
  }
  benchmark::DoNotOptimize(received);
  set_counters(state);
}
BENCHMARK(bus_message)->Arg(0)->Arg(60);

void bus_with_conversion(benchmark::State& state) {
  bus::Bus bus;
  double received = 0.0;
  bus.subscribe<ultrasonic_scan>(kChannel,
                                 [&](const ultrasonic_scan& m) { received += convert::from_message(m).max_range; });
  UltrasonicScan scan = make_scan(state);
  for (auto _ : state) {
    bus.publish(kChannel, convert::to_message(scan));
    bus.drain();
    ++scan.stamp.seq;
  }
  benchmark::DoNotOptimize(received);
  set_counters(state);
}
BENCHMARK(bus_with_conversion)->Arg(0)->Arg(60);

}  // namespace
}  // namespace noctule
