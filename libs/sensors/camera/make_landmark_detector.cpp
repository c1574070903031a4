#include "sensors/camera/make_landmark_detector.hpp"

namespace noctule::sensors {

std::unique_ptr<LandmarkDetector> make_landmark_detector(const LandmarkDetectorParameters& parameters,
                                                         const models::CameraIntrinsics& camera,
                                                         const models::CameraMounting& mounting,
                                                         const PictureReader& read_picture) {
  if (const auto* signs = std::get_if<SignDetectorParameters>(&parameters))
    return make_sign_detector(*signs, camera, mounting, read_picture);
  if (const auto* fiducials = std::get_if<FiducialParameters>(&parameters))
    return make_fiducial_detector(*fiducials, camera, mounting);
  if (const auto* posts = std::get_if<PostDetectorParameters>(&parameters))
    return make_post_detector(*posts, camera, mounting);
  return make_keypoint_detector(std::get<KeypointParameters>(parameters), camera, mounting);
}

}  // namespace noctule::sensors
