/// Guards the wire format: what is sent and recorded today must be understood tomorrow, or the change be said aloud.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cinttypes>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "bus/bus.hpp"
#include "bus/channels.hpp"
#include "convert/convert.hpp"
#include "noctule/all_types.hpp"
#include "unit/convert/random_values.hpp"
#include "unit/convert/same.hpp"

namespace noctule::convert {
namespace {

namespace fs = std::filesystem;

const fs::path kHashes = NOCTULE_SOURCE_DIR "/test/golden/wire_format.txt";
const fs::path kLog = NOCTULE_SOURCE_DIR "/test/golden/wire_format.lcmlog";
constexpr const char* kAdvice =
    "The wire format has changed: logs recorded before cannot be read any more. If that is meant, run "
    "noctule_convert_test with NOCTULE_UPDATE_GOLDEN=1 in the environment, commit test/golden/, and say so in "
    "CHANGELOG.md.";

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The golden file's content, written anew where the user asks for it.
std::string golden(const fs::path& path, const std::string& now) {
  if (std::getenv("NOCTULE_UPDATE_GOLDEN") != nullptr) std::ofstream(path, std::ios::binary) << now;
  return content(path);
}

std::string hashes() {
  std::string lines;
  std::apply(
      [&]<class... M>(const M&...) {
        const auto add = [&](const char* name, std::int64_t hash) {
          char line[80];
          std::snprintf(line, sizeof line, "%-20s 0x%016" PRIx64 "\n", name, static_cast<std::uint64_t>(hash));
          lines += line;
        };
        (add(M::getTypeName(), M::getHash()), ...);
      },
      AllTypes{});
  return lines;
}

TEST(Golden, HashesOfTheTypes) {
  EXPECT_EQ(golden(kHashes, hashes()), hashes()) << kAdvice;
}

/// One synthetic message of every type that has a core value.
void publish_all(bus::Bus& bus) {
  namespace channel = bus::channel;
  RandomValues random(42);
  bus.publish(channel::kOdometry, to_message(random.odometry()));
  bus.publish(channel::kUltrasonicScan, to_message(random.ultrasonic_scan()));
  bus.publish(channel::kLandmarkDetections, to_message(random.landmark_detections()));
  bus.publish(channel::kGroundTruth, to_message(random.ground_truth()));
  bus.publish(channel::kContourFeatures, to_message(random.contour_features()));
  bus.publish(channel::kSlamEstimate, to_message(random.slam_estimate()));
  bus.publish(channel::kSlamPath, to_message(random.path_estimate()));
  bus.publish(channel::kSlamParticles, to_message(random.particle_cloud()));
  bus.publish(channel::kSlamMap, to_message(random.landmark_map()));
  bus.publish(channel::kContourMap, to_message(random.contour_map()));
  bus.publish(channel::kCameraImage, to_message(random.camera_image()));
}

TEST(Golden, BytesOfALog) {
  const fs::path path = fs::path(testing::TempDir()) / ("golden_" + std::to_string(getpid()) + ".lcmlog");
  {
    bus::Bus bus;
    bus.record_to(bus::LogWriter(path));
    publish_all(bus);
  }
  EXPECT_TRUE(golden(kLog, content(path)) == content(path)) << kAdvice;
  fs::remove(path);
}

TEST(Golden, TheLogIsReadAsTheValuesThatWereWritten) {
  bus::LogReader log(kLog);
  RandomValues random(42);
  const auto expect_next = [&](const char* channel, const auto& value) {
    const auto event = log.next();
    ASSERT_TRUE(event.has_value()) << channel;
    EXPECT_EQ(event->channel, channel);
    EXPECT_EQ(event->utime, value.stamp.utime);
    using M = decltype(to_message(value));
    EXPECT_TRUE(same(from_message(bus::decode<M>(event->data)), value)) << channel;
  };
  expect_next("ODOMETRY", random.odometry());
  expect_next("ULTRASONIC_SCAN", random.ultrasonic_scan());
  expect_next("LANDMARK_DETECTIONS", random.landmark_detections());
  expect_next("GROUND_TRUTH", random.ground_truth());
  expect_next("CONTOUR_FEATURES", random.contour_features());
  expect_next("SLAM_ESTIMATE", random.slam_estimate());
  expect_next("SLAM_PATH", random.path_estimate());
  expect_next("SLAM_PARTICLES", random.particle_cloud());
  expect_next("SLAM_MAP", random.landmark_map());
  expect_next("CONTOUR_MAP", random.contour_map());
  expect_next("CAMERA_IMAGE", random.camera_image());
  EXPECT_FALSE(log.next().has_value());
}

}  // namespace
}  // namespace noctule::convert
