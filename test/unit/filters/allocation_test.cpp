/// Once warm, a scan allocates nothing.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "filters/slam/make_slam_filter.hpp"
#include "unit/filters/landmark_world.hpp"

#if !defined(__SANITIZE_ADDRESS__)  // which has an allocator of its own
namespace {
std::atomic<long> allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace noctule::filters {
namespace {

TEST(Allocation, AScanAllocatesNothingOnceWarm) {
  const auto world = test::small_web();
  const auto run = test::drive(world, 300.0, 1);  // more than a lap: all landmarks are known before its end
  FastSlam2Parameters learning;
  learning.noise = SightingVbNoiseParameters{};
  for (auto p : std::vector<SlamFilterParameters>{FastSlam1Parameters{}, FastSlam2Parameters{}, UFastSlamParameters{},
                                                  PsoUFastSlamParameters{}, WocpfParameters{}, learning}) {
    std::visit(
        [](auto& q) {
          if constexpr (requires { q.particles; }) q.particles = 30;
        },
        p);
    const auto filter = make_slam_filter(p, 1, {});
    std::size_t last_new = 0;
    long before = 0;
    for (std::size_t k = 0; k < run.size(); ++k) {
      if (k == run.size() - 40) {
        last_new = filter->map().landmarks.size();
        before = allocations;
      }
      test::feed(*filter, run[k]);
    }
    const long during = allocations - before;
    EXPECT_EQ(filter->map().landmarks.size(), last_new);  // else the maps had to grow
    // The one thing that grows is the list of the past poses, by doubling.
    EXPECT_LE(during, 2) << kSlamFilterNames[p.index()];
  }
}

}  // namespace
}  // namespace noctule::filters
#endif
