#pragma once
/// Pieces of a trajectory over which relative errors are taken.
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace noctule::eval {

/// Indices of the first and the last pose of a piece of the trajectory.
using Segment = std::pair<std::size_t, std::size_t>;

enum class SegmentStarts {
  every_pose,  ///< segments overlap
  end_to_end   ///< each begins where the one before ended
};

/// Of so many steps. \throws std::invalid_argument for 0 steps (all functions here: for a size that is not positive)
[[nodiscard]] std::vector<Segment> segments_by_steps(std::size_t poses, std::size_t steps, SegmentStarts);

/// To the first pose at which the way driven since the start of the segment is `length` [m] or more. Poses at which
/// the robot has not moved since the last start begin no segment.
/// \param travelled way driven up to each pose, never decreasing
[[nodiscard]] std::vector<Segment> segments_by_distance(std::span<const double> travelled, double length,
                                                        SegmentStarts);

/// To the first pose `duration` [s] or more after the start of the segment.
[[nodiscard]] std::vector<Segment> segments_by_time(std::span<const std::int64_t> utimes, double duration,
                                                    SegmentStarts);

/// From each pose to the one whose way driven since then is nearest to `length`, where it is within `tolerance` [m] of
/// it: evo's `--all_pairs` by metres, with tolerance 0.1 length.
[[nodiscard]] std::vector<Segment> segments_nearest_distance(std::span<const double> travelled, double length,
                                                             double tolerance);

}  // namespace noctule::eval
