#include "sensors/camera/landmark_camera.hpp"

#include <algorithm>
#include <cmath>

#include "core/check.hpp"

namespace noctule::sensors {
namespace {

const LandmarkCameraParameters& sound(const LandmarkCameraParameters& parameters) {
  require_sound(parameters, "camera");
  return parameters;
}

}  // namespace

std::string LandmarkCameraParameters::validate() const {
  if (!intrinsics) return "intrinsics: expected the calibration of the camera, got none";
  if (!mounting) return "mounting: expected where the camera sits on the robot, got nothing";
  if (detectors.empty()) return "detectors: expected at least one, got none";
  return {};
}

LandmarkCamera::LandmarkCamera(const LandmarkCameraParameters& parameters, const PictureReader& read_picture)
    : parameters_(sound(parameters)) {
  for (const DetectorEntry& entry : parameters.detectors) {
    detectors_.push_back(
        make_landmark_detector(entry.find, *parameters.intrinsics, *parameters.mounting, read_picture));
  }
}

LandmarkDetections LandmarkCamera::detect(const CameraImage& image) {
  LandmarkDetections all{image.stamp, parameters_.mounting->sensor_in_base(), {}};
  outlines_.clear();
  for (const auto& detector : detectors_) {
    const LandmarkDetections found = detector->detect(image);
    for (std::size_t i = 0; i < found.detections.size(); ++i) {
      const LandmarkDetection& d = found.detections[i];
      if (d.id >= 0 && std::ranges::find(all.detections, d.id, &LandmarkDetection::id) != all.detections.end())
        continue;
      all.detections.push_back(d);
      Matrix2& covariance = all.detections.back().covariance;
      if (d.kind != DetectionKind::bearing_only) covariance(0, 0) += std::pow(parameters_.range_error * d.range, 2);
      if (d.kind != DetectionKind::range_only) covariance(1, 1) += std::pow(parameters_.bearing_error, 2);
      outlines_.push_back(detector->outlines()[i]);
    }
  }
  return all;
}

}  // namespace noctule::sensors
