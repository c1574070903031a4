#pragma once
/// Names of the modules in their status.

namespace noctule::modules::name {

inline constexpr const char* kSource = "source";
inline constexpr const char* kUltrasonic = "ultrasonic";
inline constexpr const char* kCamera = "camera";
inline constexpr const char* kSlam = "slam";
inline constexpr const char* kMapper = "mapper";
inline constexpr const char* kMapperKnownPose = "mapper_known_pose";
inline constexpr const char* kMapperDeadReckoning = "mapper_dead_reckoning";

}  // namespace noctule::modules::name
