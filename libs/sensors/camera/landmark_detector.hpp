#pragma once
/// Eyes of the filters: landmarks in the pictures of one calibrated camera.
///
/// The signature of a landmark (a catalogue picture, a marker's bits, a keypoint's descriptor) stays in this room. Only
/// here is known how two of them compare, so it is here that it becomes an identity: `LandmarkDetection::id` where the
/// thing is named (signs, fiducials), or the number of its track for as long as that lasts (keypoints). Filters and
/// messages see numbers, whatever detectors come.
#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "core/observations.hpp"
#include "models/camera.hpp"

namespace noctule::sensors {

/// Where a known landmark is expected in a picture, from the map and the pose: helps to find and to tell apart, and
/// never moves a measurement.
struct LandmarkPrediction {
  std::int64_t id = -1;
  double range = 0.0;                        ///< [m] from the sensor
  double bearing = 0.0;                      ///< [rad] from the sensor's x axis, left positive
  Matrix2 covariance = Matrix2::Identity();  ///< order (range, bearing)
};

/// Where a landmark was seen in the picture: a closed polygon [pixels], or one point.
using PixelOutline = std::vector<Vector2>;

/// One landmark as a detector found it.
struct CameraFinding {
  LandmarkDetection detection;
  PixelOutline outline;
};

/// Finds landmarks of one kind. Range is the horizontal distance from the optical centre to the landmark, bearing its
/// direction in the plane from the camera's heading (the yaw of its mounting); the base stands level. The covariance
/// is that of range and bearing together, from the noise of the pixels.
class LandmarkDetector {
 public:
  /// \throws InputError when a parameter of the camera is out of its range
  LandmarkDetector(const models::CameraIntrinsics& camera, const models::CameraMounting& mounting);
  virtual ~LandmarkDetector() = default;
  LandmarkDetector(const LandmarkDetector&) = delete;
  LandmarkDetector& operator=(const LandmarkDetector&) = delete;

  /// Landmarks in the picture, each at most once, in a fixed order. Nothing in a picture without landmarks, black,
  /// saturated or made of noise; whatever is not finite or not positive definite is left out.
  /// \param expected known landmarks that may be in view; empty: no prediction
  /// \throws InputError unless the picture is whole and of the size that the camera is calibrated for, and where OpenCV
  /// gives up on it
  [[nodiscard]] LandmarkDetections detect(const CameraImage& image, std::span<const LandmarkPrediction> expected = {});

  /// Of the detections of the last detect(), in their order.
  [[nodiscard]] const std::vector<PixelOutline>& outlines() const { return outlines_; }

  [[nodiscard]] const models::CameraIntrinsics& camera() const { return camera_; }
  [[nodiscard]] const models::CameraMounting& mounting() const { return mounting_; }

 protected:
  /// Appends to `found`.
  /// \param image as the camera took it
  /// \param grey the same in one channel
  virtual void find(const CameraImage& image, const Image& grey, std::span<const LandmarkPrediction> expected,
                    std::vector<CameraFinding>& found) = 0;

 private:
  models::CameraIntrinsics camera_;
  models::CameraMounting mounting_;
  Image grey_;
  std::vector<CameraFinding> found_;
  std::vector<PixelOutline> outlines_;
};

/// Sighting of a point of the optical frame.
/// \param covariance of the point [m^2]
[[nodiscard]] LandmarkDetection plane_sighting(const models::CameraMounting& mounting, const Vector3& point,
                                               const Matrix3& covariance);

/// Inverse of it: point of the optical frame at a height over the floor.
[[nodiscard]] Vector3 point_of_sighting(const models::CameraMounting& mounting, double range, double bearing,
                                        double height);

}  // namespace noctule::sensors
