#pragma once
#include <cstdint>
#include <optional>

#include "modules/module.hpp"
#include "report/run_data.hpp"
#include "sensors/camera/landmark_camera.hpp"

namespace noctule::modules {

/// CAMERA_IMAGE -> LANDMARK_DETECTIONS, one for each image and under its number, empty or not.
/// An image that nothing can be seen in (black or saturated), that does not fit the calibration, that cannot be decoded
/// or that lies before its predecessor in time is dropped and counted.
class CameraModule : public Module {
 public:
  /// \throws InputError on parameters that make no detector, and pictures of signs that cannot be read
  CameraModule(bus::Bus& bus, const sensors::LandmarkCameraParameters& parameters);

  /// The image with the most landmarks so far; the first of them.
  [[nodiscard]] const std::optional<report::CameraExample>& example() const { return example_; }

 private:
  void take(const camera_image& message);
  void keep_as_example(const Image& image, const LandmarkDetections& detections);
  void on_finish() override;

  sensors::LandmarkCamera camera_;
  std::optional<report::CameraExample> example_;
  std::optional<std::int64_t> utime_;  ///< of the latest image
};

}  // namespace noctule::modules
