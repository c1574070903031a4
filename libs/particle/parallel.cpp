#include "particle/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace noctule::particle::detail {

void for_blocks(std::size_t n, int threads, const std::function<void(std::size_t, std::size_t)>& body) {
  const int concurrency = std::min(threads, tbb::info::default_concurrency());
  if (concurrency <= 1) {
    body(0, n);
    return;
  }
  constexpr std::size_t smallest_block = 8;  // below it handing over costs more than the work
  tbb::task_arena arena(concurrency);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, smallest_block),
                      [&](const tbb::blocked_range<std::size_t>& block) { body(block.begin(), block.end()); });
  });
}

}  // namespace noctule::particle::detail
