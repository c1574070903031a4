#include "mapping/echo_model.hpp"

#include <cmath>
#include <numbers>

namespace noctule::mapping {
EchoModel::EchoModel(const EchoModelParameters& parameters, const RobustParameters& robust)
    : parameters_(parameters),
      robust_(robust),
      log_clutter_(std::log(parameters.clutter / parameters.clutter_range) - std::log(kTwoPi)),
      log_tops_(std::log(2.0 / (kPi * std::numbers::sqrt3)) - 0.5 * std::log(kTwoPi)) {}

}  // namespace noctule::mapping
