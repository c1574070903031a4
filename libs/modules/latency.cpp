#include "modules/latency.hpp"

#include <algorithm>
#include <cmath>

namespace noctule::modules {

void LatencyHistogram::add(double seconds) {
  const double position = kPerDecade * std::log10(std::max(seconds, kLeast) / kLeast);
  const auto bin = static_cast<std::size_t>(std::min(position, static_cast<double>(bins_.size() - 1)));
  ++bins_[bin];
  ++count_;
  sum_ += seconds;
  max_ = std::max(max_, seconds);
}

double LatencyHistogram::percentile(double fraction) const {
  const double wanted = fraction * static_cast<double>(count_);
  std::int64_t below = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    below += bins_[bin];
    if (below > 0 && static_cast<double>(below) >= wanted) {
      const double upper_edge = kLeast * std::pow(10.0, static_cast<double>(bin + 1) / kPerDecade);
      return std::min(upper_edge, max_);
    }
  }
  return 0.0;
}

}  // namespace noctule::modules
