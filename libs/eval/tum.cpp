#include "eval/tum.hpp"

#include <array>
#include <cmath>
#include <cstdio>

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

}  // namespace noctule::eval
