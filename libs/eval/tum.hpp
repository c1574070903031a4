#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/trajectory3.hpp"

namespace noctule::eval {

/// A trajectory in the format of the TUM RGB-D benchmark: one line `timestamp tx ty tz qx qy qz qw` a pose, seconds
/// with six decimals, metres, unit quaternion. Every number reads back as it was.
[[nodiscard]] std::string to_tum(std::span<const TimedPose> trajectory);

/// Reads that format: numbers separated by blanks, lines that begin with # are comments; times are rounded to
/// microseconds, quaternions normalised.
/// \param place of the text, for messages: a file name
/// \throws InputError `place:line: ...`: not eight finite numbers, times that do not increase, a quaternion whose
/// length
///         is not 1 within 1 %, no pose at all
[[nodiscard]] std::vector<TimedPose3> parse_tum(std::string_view text, const std::string& place);

}  // namespace noctule::eval
