#include "eval/tum.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "core/error.hpp"
#include "eval/number_rows.hpp"
#include "eval/number_text.hpp"

namespace noctule::eval {
namespace {

/// Microseconds as seconds, exactly.
std::string seconds_text(std::int64_t utime) {
  const std::int64_t whole = utime / 1'000'000, part = utime % 1'000'000;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%s%lld.%06lld", utime < 0 ? "-" : "",
                static_cast<long long>(whole < 0 ? -whole : whole), static_cast<long long>(part < 0 ? -part : part));
  return text.data();
}

}  // namespace

std::string to_tum(std::span<const TimedPose> trajectory) {
  std::string text;
  for (const TimedPose& p : trajectory) {
    text += seconds_text(p.utime) + ' ' + shortest(p.pose.x) + ' ' + shortest(p.pose.y) + " 0 0 0 " +
            shortest(std::sin(0.5 * p.pose.yaw)) + ' ' + shortest(std::cos(0.5 * p.pose.yaw)) + '\n';
  }
  return text;
}

std::vector<TimedPose3> parse_tum(std::string_view text, const std::string& place) {
  constexpr std::array<std::string_view, 8> kColumns{"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"};
  constexpr double kLongest = 1e11;  // seconds: microseconds still fit
  std::vector<TimedPose3> trajectory;
  for (const NumberRow& row : parse_rows(text, place, kColumns, ' ')) {
    const std::vector<double>& v = row.values;
    if (std::abs(v[0]) > kLongest) refuse_row(place, row.line, "a timestamp in seconds", shortest(v[0]));
    TimedPose3 p{std::llround(1e6 * v[0]), {{v[1], v[2], v[3]}, {v[7], v[4], v[5], v[6]}}};
    if (!trajectory.empty() && p.utime <= trajectory.back().utime) {
      refuse_row(place, row.line, "a timestamp after " + seconds_text(trajectory.back().utime), shortest(v[0]));
    }
    const double length = p.pose.rotation.norm();
    if (!(std::abs(length - 1.0) <= 0.01)) {
      refuse_row(place, row.line, "a quaternion of length 1", "length " + shortest(length));
    }
    p.pose.rotation.normalize();
    trajectory.push_back(p);
  }
  if (trajectory.empty()) throw InputError(place + ": expected poses, got none");
  return trajectory;
}

}  // namespace noctule::eval
