#pragma once
/// SLAM filters as experiments name them.
#include "experiment/experiment.hpp"
#include "filters/slam/make_slam_filter.hpp"

namespace noctule::experiment {

/// Lines to see SLAM filters by.
inline constexpr const char* kDeadReckoning = "dead_reckoning";
inline constexpr const char* kKnownPose = "known_pose";  ///< mapping along the true path
inline constexpr const char* kSmoother = "smoother";     ///< batch maximum likelihood, associations known

/// A SLAM filter, told by the key `type` which, that knows of each sighting how large its noise was.
inline constexpr const char* kOracle = "oracle";

/// Whether filters::make_slam_filter knows the name.
[[nodiscard]] bool is_slam_filter(const std::string& name);

/// The effective configuration of a filter whose name is one of filters::kSlamFilterNames; its `type` is that name and
/// may be left out. That of kOracle names any of them. \throws InputError for another type and whatever else is wrong
/// with it
[[nodiscard]] filters::SlamFilterParameters slam_filter_parameters(const FilterSpec& filter);

}  // namespace noctule::experiment
