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

std::vector<int> log_ticks(double low, double high, int count) {
  const int first = static_cast<int>(std::ceil(std::log10(low) - 1e-9));
  const int last = static_cast<int>(std::floor(std::log10(high) + 1e-9));
  const int step = std::max(1, static_cast<int>(std::ceil(static_cast<double>(last - first + 1) / count)));
  std::vector<int> exponents;
  for (int k = first; k <= last; k += step) exponents.push_back(k);
  return exponents;
}

}  // namespace noctule::report
