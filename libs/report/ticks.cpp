#include "report/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

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

std::vector<LogTick> log_ticks(double low, double high, int count) {
  const auto multiples = [&](std::initializer_list<int> digits) {
    std::vector<LogTick> ticks;
    const int first = static_cast<int>(std::floor(std::log10(low) + 1e-9)),
              last = static_cast<int>(std::log10(high)) + 1;
    for (int k = first; k <= last; ++k) {
      for (const int digit : digits) {
        const double value = digit * std::pow(10.0, k);
        if (value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9)) ticks.push_back({digit, k});
      }
    }
    return ticks;
  };
  constexpr std::size_t kFewest = 3;
  std::vector<LogTick> ticks = multiples({1});
  if (ticks.size() >= kFewest) {
    const std::size_t step = (ticks.size() + static_cast<std::size_t>(count) - 1) / static_cast<std::size_t>(count);
    std::vector<LogTick> sparse;
    for (std::size_t i = 0; i < ticks.size(); i += step) sparse.push_back(ticks[i]);
    return sparse;
  }
  ticks = multiples({1, 2, 5});
  return ticks.size() >= kFewest ? ticks : multiples({1, 2, 3, 4, 5, 6, 7, 8, 9});
}

}  // namespace noctule::report
