#include "filters/slam/make_slam_filter.hpp"

#include "filters/slam/particle_slam.hpp"

namespace noctule::filters {
namespace {

std::unique_ptr<SlamFilter> make(ParticleSlamParameters p, std::uint64_t seed, const Pose2& start, int threads) {
  p.threads = threads;
  return std::make_unique<ParticleSlam>(p, seed, start);
}

}  // namespace

std::unique_ptr<SlamFilter> make_slam_filter(const SlamFilterParameters& parameters, std::uint64_t seed,
                                             const Pose2& start, int threads) {
  return std::visit([&](const auto& p) { return make(p, seed, start, threads); }, parameters);
}

}  // namespace noctule::filters
