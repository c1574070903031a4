#pragma once
/// Core values to messages and back. A value survives the way there and back to the bit.
///
/// from_message() lets nothing into the program that an algorithm would have to doubt: it throws noctule::InputError
/// naming type, field, expected and got (`ultrasonic_scan.beams[3].range_m: expected a finite number >= 0, got nan`)
/// for numbers that are not finite or out of their limits, codes that no enum has, counts that differ from what they
/// count, matrices that are no covariance, and frames other than the type's.
#include "core/contour.hpp"
#include "core/estimate.hpp"
#include "core/features.hpp"
#include "core/image.hpp"
#include "core/observations.hpp"
#include "noctule/camera_image.hpp"
#include "noctule/contour_features.hpp"
#include "noctule/contour_map.hpp"
#include "noctule/ground_truth.hpp"
#include "noctule/landmark_detections.hpp"
#include "noctule/landmark_map.hpp"
#include "noctule/odometry.hpp"
#include "noctule/particles.hpp"
#include "noctule/path_estimate.hpp"
#include "noctule/slam_estimate.hpp"
#include "noctule/ultrasonic_scan.hpp"

namespace noctule::convert {

inline constexpr const char* kBaseFrame = "base_link";         ///< of observations and features
inline constexpr const char* kCameraFrame = "camera_optical";  ///< of images
inline constexpr const char* kMapFrame = "map";                ///< of estimates and of the truth

[[nodiscard]] odometry to_message(const Odometry&);
[[nodiscard]] ultrasonic_scan to_message(const UltrasonicScan&);
[[nodiscard]] landmark_detections to_message(const LandmarkDetections&);
[[nodiscard]] ground_truth to_message(const GroundTruth&);
[[nodiscard]] camera_image to_message(const CameraImage&);
[[nodiscard]] contour_features to_message(const ContourFeatures&);
[[nodiscard]] slam_estimate to_message(const SlamEstimate&);
[[nodiscard]] path_estimate to_message(const PathEstimate&);
[[nodiscard]] particles to_message(const ParticleCloud&);
[[nodiscard]] landmark_map to_message(const LandmarkMap&);
[[nodiscard]] contour_map to_message(const ContourMap&);

[[nodiscard]] Odometry from_message(const odometry&);
[[nodiscard]] UltrasonicScan from_message(const ultrasonic_scan&);
[[nodiscard]] LandmarkDetections from_message(const landmark_detections&);
[[nodiscard]] GroundTruth from_message(const ground_truth&);
/// Raw pixels only: whoever takes JPEG decodes it first (datasets/images.hpp).
[[nodiscard]] CameraImage from_message(const camera_image&);
[[nodiscard]] ContourFeatures from_message(const contour_features&);
[[nodiscard]] SlamEstimate from_message(const slam_estimate&);
[[nodiscard]] PathEstimate from_message(const path_estimate&);
[[nodiscard]] ParticleCloud from_message(const particles&);
[[nodiscard]] LandmarkMap from_message(const landmark_map&);
[[nodiscard]] ContourMap from_message(const contour_map&);

}  // namespace noctule::convert
