/// Sends a message of every type on every channel to a udpm bus, again and again until it is killed, and on NOT_A_TYPE
/// bytes that are none. Usage: bus_publisher URL
#include <chrono>
#include <iostream>
#include <thread>

#include "bus/bus.hpp"
#include "bus/channels.hpp"
#include "convert/convert.hpp"
#include "noctule/contour_errors.hpp"
#include "noctule/module_status.hpp"
#include "noctule/timing.hpp"
#include "unit/convert/random_values.hpp"

namespace noctule {
namespace {

/// The message as number `seq` of its channel.
template <bus::Message M>
void publish(bus::Bus& bus, const char* channel, M message, std::int64_t seq) {
  message.utime = 1000 * seq;
  message.seq = seq;
  bus.publish(channel, message);
}

void publish_round(bus::Bus& bus, convert::RandomValues& random, std::int64_t seq) {
  namespace channel = bus::channel;
  using convert::to_message;
  publish(bus, channel::kOdometry, to_message(random.odometry()), seq);
  publish(bus, channel::kUltrasonicScan, to_message(random.ultrasonic_scan()), seq);
  publish(bus, channel::kLandmarkDetections, to_message(random.landmark_detections()), seq);
  publish(bus, channel::kGroundTruth, to_message(random.ground_truth()), seq);
  publish(bus, channel::kCameraImage, to_message(random.camera_image()), seq);
  publish(bus, channel::kContourFeatures, to_message(random.contour_features()), seq);
  publish(bus, channel::kSlamEstimate, to_message(random.slam_estimate()), seq);
  publish(bus, channel::kSlamPath, to_message(random.path_estimate()), seq);
  publish(bus, channel::kSlamParticles, to_message(random.particle_cloud()), seq);
  publish(bus, channel::kSlamMap, to_message(random.landmark_map()), seq);
  for (const char* map : {channel::kContourMap, channel::kContourMapKnownPose, channel::kContourMapDeadReckoning})
    publish(bus, map, to_message(random.contour_map()), seq);
  publish(bus, channel::kContourErrors, contour_errors{}, seq);
  publish(bus, channel::kModuleStatus, module_status{}, seq);
  publish(bus, channel::kTiming, timing{}, seq);
  const std::vector<std::uint8_t> nonsense(64, 0x5a);
  bus.publish_bytes("NOT_A_TYPE", 0, nonsense);
}

}  // namespace
}  // namespace noctule

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: bus_publisher URL\n";
    return 2;
  }
  try {
    noctule::bus::Bus bus(argv[1]);
    noctule::convert::RandomValues random(1);
    for (std::int64_t seq = 0;; ++seq) {
      noctule::publish_round(bus, random, seq);
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
    }
  } catch (const noctule::InputError& error) {
    std::cerr << "bus_publisher: " << error.what() << '\n';
    return 2;
  }
}
