#include "filters/slam/make_slam_filter.hpp"

#include "filters/slam/ekf_slam.hpp"
#include "filters/slam/fastslam.hpp"
#include "filters/slam/particle_slam.hpp"
#include "filters/slam/ufastslam.hpp"
#include "filters/slam/wocpf.hpp"

namespace noctule::filters {
namespace {

/// The filter of each kind of parameters.
template <class Parameters>
struct FilterOf;
template <>
struct FilterOf<ParticleSlamParameters> {
  using type = ParticleSlam;
};
template <>
struct FilterOf<VbParticleSlamParameters> {
  using type = ParticleSlam;
};
template <>
struct FilterOf<EmParticleSlamParameters> {
  using type = ParticleSlam;
};
template <>
struct FilterOf<FastSlam1Parameters> {
  using type = FastSlam1;
};
template <>
struct FilterOf<FastSlam2Parameters> {
  using type = FastSlam2;
};

template <>
struct FilterOf<UFastSlamParameters> {
  using type = UFastSlam;
};
template <>
struct FilterOf<PsoUFastSlamParameters> {
  using type = PsoUFastSlam;
};

template <class Parameters>
std::unique_ptr<SlamFilter> make(Parameters p, std::uint64_t seed, const Pose2& start, int threads) {
  p.threads = threads;
  return std::make_unique<typename FilterOf<Parameters>::type>(p, seed, start);
}

std::unique_ptr<SlamFilter> make(const EkfSlamParameters& p, std::uint64_t, const Pose2& start, int) {
  return std::make_unique<EkfSlam>(p, start);
}

std::unique_ptr<SlamFilter> make(const WocpfParameters& p, std::uint64_t seed, const Pose2& start, int threads) {
  return make_wocpf(p, seed, start, threads);
}

}  // namespace

std::unique_ptr<SlamFilter> make_slam_filter(const SlamFilterParameters& parameters, std::uint64_t seed,
                                             const Pose2& start, int threads) {
  return std::visit([&](const auto& p) { return make(p, seed, start, threads); }, parameters);
}

}  // namespace noctule::filters
