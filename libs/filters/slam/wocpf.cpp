#include "filters/slam/wocpf.hpp"

#include "core/check.hpp"
#include "filters/slam/fastslam.hpp"
#include "filters/slam/ufastslam.hpp"

namespace noctule::filters {

std::unique_ptr<SlamFilter> make_wocpf(WocpfParameters parameters, std::uint64_t seed, const Pose2& start,
                                       int threads) {
  require_sound(parameters, "WOCPF");
  parameters.threads = threads;
  if (parameters.base == WocpfBase::fastslam2) {
    return std::make_unique<FastSlam2>(parameters, seed, start, parameters.offspring);
  }
  if (parameters.base == WocpfBase::ufastslam) {
    return std::make_unique<UFastSlam>(parameters, seed, start, parameters.offspring);
  }
  FastSlam1Parameters base;
  static_cast<LandmarkSlamParameters&>(base) = parameters;
  return std::make_unique<FastSlam1>(base, seed, start, parameters.offspring);
}

}  // namespace noctule::filters
