#pragma once
/// One calibrated camera and all that is looked for in its pictures.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sensors/camera/make_landmark_detector.hpp"

namespace noctule::sensors {

/// One kind of landmark to look for.
struct DetectorEntry {
  LandmarkDetectorParameters find;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.one_of("find", &DetectorEntry::find, kLandmarkDetectorNames, "what is looked for");
  }
};

struct LandmarkCameraParameters {
  std::optional<models::CameraIntrinsics> intrinsics;
  std::optional<models::CameraMounting> mounting;
  double bearing_error = radians(0.1);
  double range_error = 0.005;
  std::vector<DetectorEntry> detectors;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = LandmarkCameraParameters;
    v.group("intrinsics", &P::intrinsics, "the calibration of the camera");
    v.group("mounting", &P::mounting, "where it sits on the robot");
    v.field("bearing_error_deg", &P::bearing_error, unit::degree,
            "standard deviation of what calibration and mounting leave in every bearing", at_least(0.0));
    v.field("range_error", &P::range_error, unit::one, "the same of every range, as a fraction of it", at_least(0.0));
    v.list("detectors", &P::detectors, "what is looked for in each picture");
  }
  [[nodiscard]] std::string validate() const;
};

/// All detectors, as one.
class LandmarkCamera {
 public:
  /// \param read_picture for signs whose picture is a file
  /// \throws InputError on parameters that make no detector
  explicit LandmarkCamera(const LandmarkCameraParameters& parameters, const PictureReader& read_picture = {});

  /// What the detectors see, in their order; an identity that two of them see counts once. Their covariances are those
  /// of the pixel noise; the errors of calibration and mounting are added.
  /// \throws InputError unless the picture is whole and of the size that the camera is calibrated for
  [[nodiscard]] LandmarkDetections detect(const CameraImage& image);
  /// Of the detections of the last detect(), in their order.
  [[nodiscard]] const std::vector<PixelOutline>& outlines() const { return outlines_; }

 private:
  LandmarkCameraParameters parameters_;
  std::vector<std::unique_ptr<LandmarkDetector>> detectors_;
  std::vector<PixelOutline> outlines_;
};

}  // namespace noctule::sensors
