#pragma once
#include <cstddef>
#include <functional>

namespace noctule::particle {

namespace detail {
void for_blocks(std::size_t n, int threads, const std::function<void(std::size_t, std::size_t)>& body);
}

/// Calls body(begin, end) for consecutive blocks that make up [0, n), on at most `threads` threads (and no
/// more than the machine has cores); with one thread it is a plain call of body(0, n). What body computes for an index
/// must depend on that index alone: then the result is the same for any number of threads. An exception of body is
/// rethrown.
template <class Body>
void for_blocks(std::size_t n, int threads, const Body& body) {
  detail::for_blocks(n, threads, std::cref(body));
}

}  // namespace noctule::particle
