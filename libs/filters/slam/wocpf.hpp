#pragma once
#include <memory>

#include "filters/slam/landmark_parameters.hpp"
#include "filters/slam/slam_filter.hpp"

namespace noctule::filters {

/// The base filter of the parameters with their way of drawing offspring.
[[nodiscard]] std::unique_ptr<SlamFilter> make_wocpf(WocpfParameters parameters, std::uint64_t seed, const Pose2& start,
                                                     int threads);

}  // namespace noctule::filters
