#include "modules/camera_module.hpp"

#include "datasets/images.hpp"
#include "modules/names.hpp"
#include "noctule/camera_image.hpp"

namespace noctule::modules {
namespace {

constexpr double kDarkest = 3.0, kBrightest = 252.0;  // mean of an image in which something can be seen [grey levels]

/// Of every 61st byte: no row or channel is preferred.
double mean_grey(const Image& image) {
  constexpr std::size_t kStep = 61;
  double sum = 0.0;
  for (std::size_t i = 0; i < image.pixels.size(); i += kStep) sum += image.pixels[i];
  return sum / static_cast<double>((image.pixels.size() + kStep - 1) / kStep);
}

}  // namespace

CameraModule::CameraModule(bus::Bus& bus, const sensors::LandmarkCameraParameters& parameters)
    : Module(bus, name::kCamera), camera_(parameters, datasets::read_image) {
  listen_to_message<camera_image>(bus::channel::kCameraImage, [this](const camera_image& m) { take(m); });
  finish_after({name::kSource});
}

void CameraModule::take(const camera_image& message) {
  CameraImage image;
  if (message.encoding == camera_image::ENCODING_JPEG) {
    image = {{message.utime, message.seq}, datasets::decode_image(message.bytes)};
  } else {
    image = convert::from_message(message);
  }
  const std::string which = "image " + std::to_string(message.seq);
  const bool backwards = utime_ && message.utime <= *utime_;
  utime_ = message.utime;
  if (backwards) return count_dropped(which + " is stamped before the one that came before it");
  if (const double mean = mean_grey(image.image); mean < kDarkest || mean > kBrightest) {
    return count_dropped(which + (mean < kDarkest ? " is black" : " is saturated"));
  }
  const LandmarkDetections detections = camera_.detect(image);
  keep_as_example(image.image, detections);
  publish_as_numbered(bus::channel::kLandmarkDetections, detections);
}

void CameraModule::on_finish() {
  if (!utime_) warn("no image has come: nothing was looked for");
}

void CameraModule::keep_as_example(const Image& image, const LandmarkDetections& detections) {
  const std::size_t count = detections.detections.size();
  if (count == 0 || (example_ && example_->landmarks.size() >= count)) return;
  example_.emplace(report::CameraExample{seconds(detections.stamp.utime), image, {}});
  for (std::size_t i = 0; i < count; ++i) {
    const LandmarkDetection& d = detections.detections[i];
    example_->landmarks.push_back({d.id, d.range, d.bearing, camera_.outlines()[i]});
  }
}

}  // namespace noctule::modules
