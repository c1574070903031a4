#pragma once
/// All SLAM filters by name. A new one needs its own files, an alternative here with its name, and a line in the
/// source.
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "filters/slam/landmark_parameters.hpp"
#include "filters/slam/parameters.hpp"
#include "filters/slam/slam_filter.hpp"

namespace noctule::filters {

/// Which filter, and with which parameters; in files told apart by the key `type`.
using SlamFilterParameters =
    std::variant<ParticleSlamParameters, VbParticleSlamParameters, EmParticleSlamParameters, FastSlam1Parameters,
                 FastSlam2Parameters, UFastSlamParameters, PsoUFastSlamParameters, WocpfParameters, EkfSlamParameters>;

/// Names of the alternatives, in their order.
inline const std::vector<std::string> kSlamFilterNames{"pf",        "vb_pf",         "em_pf", "fastslam1", "fastslam2",
                                                       "ufastslam", "pso_ufastslam", "wocpf", "ekf_slam"};

/// \param start pose of the base in the map at the first observation, taken as certain
/// \param threads most threads to use; no result depends on it
/// \throws InputError on a start that is not finite or parameters that make no filter
[[nodiscard]] std::unique_ptr<SlamFilter> make_slam_filter(const SlamFilterParameters& parameters, std::uint64_t seed,
                                                           const Pose2& start, int threads = 1);

}  // namespace noctule::filters
