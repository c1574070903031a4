#include "report/axis.hpp"

#include <algorithm>
#include <cmath>

#include "report/text.hpp"
#include "report/ticks.hpp"

namespace noctule::report {

void ValueRange::include(double value) {
  if (!std::isfinite(value) || (positive_only_ && value <= 0.0)) return;
  low_ = std::min(low_, value);
  high_ = std::max(high_, value);
}

Axis::Axis(double low, double high, bool logarithmic, double from, double to)
    : logarithmic_(logarithmic),
      low_(logarithmic ? std::log10(low) : low),
      high_(logarithmic ? std::log10(high) : high),
      from_(from),
      to_(to) {}

Axis::Axis(const ValueRange& values, bool logarithmic, double from, double to)
    : logarithmic_(logarithmic), low_(-1.0), high_(1.0), from_(from), to_(to) {
  if (values.empty()) {
    if (logarithmic) high_ = 0.0;
  } else if (logarithmic) {
    low_ = std::log10(values.low()) - 0.05;
    high_ = std::log10(values.high()) + 0.05;
  } else {
    const double pad = values.high() > values.low() ? 0.06 * (values.high() - values.low()) : 0.5;
    low_ = values.low() == 0.0 ? 0.0 : values.low() - pad;
    high_ = values.high() + pad;
  }
}

double Axis::at(double value) const {
  const double v = logarithmic_ ? std::log10(value) : value;
  return from_ + (v - low_) / (high_ - low_) * (to_ - from_);
}

bool Axis::drawable(double value) const {
  return std::isfinite(value) && (!logarithmic_ || value > 0.0);
}

std::vector<Axis::Tick> Axis::ticks(int count) const {
  std::vector<Tick> ticks;
  if (!logarithmic_) {
    const Ticks linear = linear_ticks(low_, high_, count);
    for (const double v : linear.values) ticks.push_back({v, aligned(v, linear.decimals)});
    return ticks;
  }
  for (const LogTick& tick : log_ticks(std::pow(10.0, low_), std::pow(10.0, high_), count)) {
    const double value = tick.digit * std::pow(10.0, tick.exponent);
    const bool power = std::abs(tick.exponent) > 3 && tick.digit == 1;
    ticks.push_back({value, power ? power_of_ten(tick.exponent) : fixed(value, std::max(0, -tick.exponent))});
  }
  return ticks;
}

}  // namespace noctule::report
