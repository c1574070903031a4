#include "eval/segments.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace noctule::eval {
namespace {

void require_positive(bool positive) {
  if (!positive) throw std::invalid_argument("segments: their size must be positive");
}

/// \param end_of index of the last pose of a segment from a start, or the number of poses where there is none
/// \param is_start whether a segment may begin at a pose, given where the last one began
template <class EndOf, class IsStart>
std::vector<Segment> collect(std::size_t poses, SegmentStarts starts, EndOf end_of, IsStart is_start) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < poses;) {
    if (!segments.empty() && !is_start(i, segments.back().first)) {
      ++i;
      continue;
    }
    const std::size_t end = end_of(i);
    if (end >= poses) break;
    segments.emplace_back(i, end);
    i = starts == SegmentStarts::end_to_end ? end : i + 1;
  }
  return segments;
}

constexpr auto kAnywhere = [](std::size_t, std::size_t) { return true; };

}  // namespace

std::vector<Segment> segments_by_steps(std::size_t poses, std::size_t steps, SegmentStarts starts) {
  require_positive(steps > 0);
  return collect(
      poses, starts, [&](std::size_t i) { return i + steps; }, kAnywhere);
}

std::vector<Segment> segments_by_distance(std::span<const double> travelled, double length, SegmentStarts starts) {
  require_positive(length > 0.0);
  constexpr double kRounding = 1e-9;  // of a sum of steps that should make the length exactly
  const auto end_of = [&](std::size_t i) {
    const auto end = std::lower_bound(travelled.begin() + static_cast<std::ptrdiff_t>(i), travelled.end(),
                                      travelled[i] + length - kRounding);
    return static_cast<std::size_t>(end - travelled.begin());
  };
  return collect(travelled.size(), starts, end_of,
                 [&](std::size_t i, std::size_t last) { return travelled[i] > travelled[last]; });
}

std::vector<Segment> segments_by_time(std::span<const std::int64_t> utimes, double duration, SegmentStarts starts) {
  require_positive(duration > 0.0);
  const std::int64_t span = std::llround(1e6 * duration);
  const auto end_of = [&](std::size_t i) {
    const auto end = std::lower_bound(utimes.begin() + static_cast<std::ptrdiff_t>(i), utimes.end(), utimes[i] + span);
    return static_cast<std::size_t>(end - utimes.begin());
  };
  return collect(utimes.size(), starts, end_of, kAnywhere);
}

std::vector<Segment> segments_nearest_distance(std::span<const double> travelled, double length, double tolerance) {
  require_positive(length > 0.0);
  std::vector<Segment> segments;
  for (std::size_t i = 0; i + 1 < travelled.size(); ++i) {
    const auto miss = [&](std::size_t j) { return std::abs(travelled[j] - travelled[i] - length); };
    std::size_t best = i + 1;
    for (std::size_t j = best + 1; j < travelled.size(); ++j) best = miss(j) < miss(best) ? j : best;
    if (miss(best) <= tolerance) segments.emplace_back(i, best);
  }
  return segments;
}

}  // namespace noctule::eval
