#pragma once
/// Names for the two numbers that are none.
#include <limits>

namespace noctule {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace noctule
