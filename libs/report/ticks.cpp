#include "report/ticks.hpp"

#include <algorithm>
#include <cmath>

namespace noctule::report {

double nice_step(double rough) {
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double m : {1.0, 2.0, 5.0}) {
    if (m * power >= rough * (1.0 - 1e-9)) return m * power;
  }
  return 10.0 * power;
}

Ticks linear_ticks(double low, double high, int count) {
  const double step = nice_step((high - low) / count);
  Ticks ticks;
  ticks.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0) {
    ticks.values.push_back(k * step);
  }
  return ticks;
}

Ticks log_ticks(double low, double high) {
  Ticks ticks;
  const double first = std::ceil(std::log10(low) - 1e-9);
  ticks.decimals = std::max(0, static_cast<int>(-first));
  for (double k = first; k <= std::log10(high) + 1e-9; k += 1.0) ticks.values.push_back(std::pow(10.0, k));
  return ticks;
}

}  // namespace noctule::report
