#pragma once
/// All landmark detectors by name. A new one needs its own files, an alternative here with its name, and a line in the
/// source.
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "sensors/camera/fiducials.hpp"
#include "sensors/camera/keypoints.hpp"
#include "sensors/camera/posts.hpp"
#include "sensors/camera/signs.hpp"

namespace noctule::sensors {

/// Which detector, and with which parameters; in files told apart by the key `type`.
using LandmarkDetectorParameters =
    std::variant<SignDetectorParameters, FiducialParameters, PostDetectorParameters, KeypointParameters>;

/// Names of the alternatives, in their order.
inline const std::vector<std::string> kLandmarkDetectorNames{"signs", "fiducials", "posts", "keypoints"};

/// \param read_picture for signs whose picture is a file
/// \throws InputError on parameters that make no detector
[[nodiscard]] std::unique_ptr<LandmarkDetector> make_landmark_detector(const LandmarkDetectorParameters& parameters,
                                                                       const models::CameraIntrinsics& camera,
                                                                       const models::CameraMounting& mounting,
                                                                       const PictureReader& read_picture = {});

}  // namespace noctule::sensors
