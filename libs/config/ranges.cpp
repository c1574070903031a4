#include "config/ranges.hpp"

#include <cmath>

#include "config/number.hpp"

namespace noctule::config {

bool contains(const Range& range, double value) {
  const bool above = range.min_allowed ? value >= range.min : value > range.min;
  const bool below = range.max_allowed ? value <= range.max : value < range.max;
  return above && below;
}

std::string to_string(const Range& range) {
  const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
  const std::string min = print_number(range.min, 1.0), max = print_number(range.max, 1.0);
  if (low && high)
    return std::string("in ") + (range.min_allowed ? "[" : "(") + min + ", " + max + (range.max_allowed ? "]" : ")");
  if (low) return (range.min_allowed ? ">= " : "> ") + min;
  if (high) return (range.max_allowed ? "<= " : "< ") + max;
  return "";
}

}  // namespace noctule::config
