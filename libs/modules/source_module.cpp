#include "modules/source_module.hpp"

#include "core/error.hpp"
#include "core/observation_order.hpp"
#include "datasets/images.hpp"
#include "modules/names.hpp"
#include "noctule/camera_image.hpp"
#include "noctule/ground_truth.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/odometry.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::modules {
namespace {

const char* channel_of(const Odometry&) {
  return bus::channel::kOdometry;
}
const char* channel_of(const UltrasonicScan&) {
  return bus::channel::kUltrasonicScan;
}
const char* channel_of(const LandmarkDetections&) {
  return bus::channel::kLandmarkDetections;
}
const char* channel_of(const GroundTruth&) {
  return bus::channel::kGroundTruth;
}

const char* channel_of(const CameraImage&) {
  return bus::channel::kCameraImage;
}

/// Own utime of the message if the channel is one of observations.
/// \throws InputError when the bytes are no such message
std::optional<std::int64_t> observation_utime(const bus::LogEvent& event) {
  if (event.channel == bus::channel::kOdometry) return bus::decode<odometry>(event.data).utime;
  if (event.channel == bus::channel::kUltrasonicScan) return bus::decode<ultrasonic_scan>(event.data).utime;
  if (event.channel == bus::channel::kLandmarkDetections) return bus::decode<landmark_detections>(event.data).utime;
  if (event.channel == bus::channel::kGroundTruth) return bus::decode<ground_truth>(event.data).utime;
  if (event.channel == bus::channel::kCameraImage) return bus::decode<camera_image>(event.data).utime;
  return std::nullopt;
}

}  // namespace

SourceModule::SourceModule(bus::Bus& bus) : Module(bus, name::kSource) {}

bool SourceModule::step() {
  if (finished()) return false;
  const auto utime = next_utime();
  if (!utime) {
    finish();
    return false;
  }
  guard(*utime, [this] { publish_next(); });
  return true;
}

ObservationModule::ObservationModule(bus::Bus& bus, std::unique_ptr<ObservationSource> source, int jpeg_quality)
    : SourceModule(bus), source_(std::move(source)), jpeg_quality_(jpeg_quality) {}

std::optional<std::int64_t> ObservationModule::next_utime() {
  if (!next_ && !ended_) next_ = source_->next();
  ended_ = !next_;
  if (ended_) return std::nullopt;
  return stamp_of(*next_).utime;
}

void ObservationModule::publish_next() {
  const auto* image = std::get_if<CameraImage>(&*next_);
  if (image != nullptr && jpeg_quality_ > 0) {
    publish_as_jpeg(*image);
  } else {
    std::visit([this](const auto& observation) { publish_as_numbered(channel_of(observation), observation); }, *next_);
  }
  next_.reset();
}

void ObservationModule::publish_as_jpeg(const CameraImage& image) {
  CameraImage empty{image.stamp, {}};
  empty.image.width = image.image.width;
  empty.image.height = image.image.height;
  camera_image message = convert::to_message(empty);
  message.encoding = camera_image::ENCODING_JPEG;
  message.bytes = datasets::encode_jpeg(image.image, jpeg_quality_);
  message.byte_count = static_cast<std::int32_t>(message.bytes.size());
  publish_as_numbered(bus::channel::kCameraImage, message);
}

LogModule::LogModule(bus::Bus& bus, const std::filesystem::path& log, bool sightings)
    : SourceModule(bus), reader_(log), sightings_(sightings) {}

std::optional<std::int64_t> LogModule::next_utime() {
  if (!next_) read_next();
  if (!next_) return std::nullopt;
  return next_->utime;
}

void LogModule::publish_next() {
  publish_bytes(next_->channel, next_->utime, next_->data);
  next_.reset();
}

void LogModule::read_next() {
  while ((next_ = reader_.next())) {
    ++events_;
    if (!sightings_ && next_->channel == bus::channel::kLandmarkDetections) continue;
    try {
      const auto utime = observation_utime(*next_);
      if (!utime) continue;
      next_->utime = *utime;
      return;
    } catch (const InputError& error) {
      throw InputError(reader_.path().string() + ": message " + std::to_string(events_) + " on " + next_->channel +
                       ": " + error.what());
    }
  }
  if (reader_.truncated_bytes() > 0) {
    warn(reader_.path().string() + " was cut off: its last " + std::to_string(reader_.truncated_bytes()) +
         " bytes are no whole message");
  }
}

}  // namespace noctule::modules
