#pragma once
#include <string>

namespace noctule::eval {

/// A measured figure. It never travels without its unit.
struct Metric {
  std::string name;    ///< snake_case, without the unit
  double value = 0.0;  ///< not finite: could not be measured
  std::string unit;    ///< "m", "rad", "s", "1" ...: SI only
};

}  // namespace noctule::eval
