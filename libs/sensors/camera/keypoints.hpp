#pragma once
/// Natural keypoints followed from picture to picture.
#include <memory>

#include "core/parameters.hpp"
#include "sensors/camera/landmark_detector.hpp"

namespace noctule::sensors {

struct KeypointParameters {
  int keypoints = 40;      ///< followed at a time, at most
  double apart_px = 40.0;  ///< least distance of two
  int stable_frames = 8;   ///< in which a keypoint must have been followed
  double return_px = 0.5;  ///< followed there and back it must come home so near
  int max_bits = 60;       ///< by which its descriptor may differ from the first one
  double pixel_sd = 0.5;   ///< of its place
  std::int64_t first_id = 1000000;
  int memory = 400;  ///< lost keypoints that can be recognised

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = KeypointParameters;
    v.field("keypoints", &P::keypoints, unit::one, "keypoints followed at a time, at most", between(1, 1000));
    v.field("apart_px", &P::apart_px, unit::one, "least distance of two in pixels", at_least(5.0));
    v.field("stable_frames", &P::stable_frames, unit::one, "pictures in which a keypoint must have been followed",
            at_least(2));
    v.field("return_px", &P::return_px, unit::one, "followed to the next picture and back, it must come home so near",
            positive());
    v.field("max_bits", &P::max_bits, unit::one, "bits by which its descriptor may differ from the first one",
            between(0, 256));
    v.field("pixel_sd", &P::pixel_sd, unit::one, "sd of its place in pixels", positive());
    v.field("first_id", &P::first_id, unit::one, "identity of the first keypoint; the next ones count on", at_least(0));
    v.field("memory", &P::memory, unit::one, "lost keypoints that can be recognised", between(0, 100000));
  }
};

/// Corners followed by Lucas and Kanade's method. A keypoint becomes a landmark, seen by its bearing alone, once it has
/// been followed over enough pictures (stable), there and back, and still has the descriptor that it was found with
/// (repeatable). A new one whose descriptor is that of a lost one and of no other gets its identity back.
[[nodiscard]] std::unique_ptr<LandmarkDetector> make_keypoint_detector(const KeypointParameters& parameters,
                                                                       const models::CameraIntrinsics& camera,
                                                                       const models::CameraMounting& mounting);

}  // namespace noctule::sensors
