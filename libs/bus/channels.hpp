#pragma once
/// Names of the channels; types/CHANNELS.md says who publishes what at which rate.
#include <array>
#include <string_view>

namespace noctule::bus::channel {

inline constexpr const char* kOdometry = "ODOMETRY";
inline constexpr const char* kUltrasonicScan = "ULTRASONIC_SCAN";
inline constexpr const char* kLandmarkDetections = "LANDMARK_DETECTIONS";
inline constexpr const char* kGroundTruth = "GROUND_TRUTH";
inline constexpr const char* kCameraImage = "CAMERA_IMAGE";
inline constexpr const char* kContourFeatures = "CONTOUR_FEATURES";
inline constexpr const char* kSlamEstimate = "SLAM_ESTIMATE";
inline constexpr const char* kSlamPath = "SLAM_PATH";
inline constexpr const char* kSlamParticles = "SLAM_PARTICLES";
inline constexpr const char* kSlamMap = "SLAM_MAP";
inline constexpr const char* kContourMap = "CONTOUR_MAP";
inline constexpr const char* kContourMapKnownPose = "CONTOUR_MAP_KNOWN_POSE";
inline constexpr const char* kContourMapDeadReckoning = "CONTOUR_MAP_DEAD_RECKONING";
inline constexpr const char* kContourErrors = "CONTOUR_ERRORS";
inline constexpr const char* kModuleStatus = "MODULE_STATUS";
inline constexpr const char* kTiming = "TIMING";

struct ChannelType {
  std::string_view channel;
  std::string_view type;  ///< name of the LCM type
};

inline constexpr std::array kAll = {ChannelType{kOdometry, "odometry"},
                                    ChannelType{kUltrasonicScan, "ultrasonic_scan"},
                                    ChannelType{kLandmarkDetections, "landmark_detections"},
                                    ChannelType{kGroundTruth, "ground_truth"},
                                    ChannelType{kCameraImage, "camera_image"},
                                    ChannelType{kContourFeatures, "contour_features"},
                                    ChannelType{kSlamEstimate, "slam_estimate"},
                                    ChannelType{kSlamPath, "path_estimate"},
                                    ChannelType{kSlamParticles, "particles"},
                                    ChannelType{kSlamMap, "landmark_map"},
                                    ChannelType{kContourMap, "contour_map"},
                                    ChannelType{kContourMapKnownPose, "contour_map"},
                                    ChannelType{kContourMapDeadReckoning, "contour_map"},
                                    ChannelType{kContourErrors, "contour_errors"},
                                    ChannelType{kModuleStatus, "module_status"},
                                    ChannelType{kTiming, "timing"}};

}  // namespace noctule::bus::channel
