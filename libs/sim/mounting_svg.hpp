#pragma once
#include <string>

#include "sim/robot.hpp"

namespace noctule::sim {

/// A drawing of the base from above, forward to the right, with every ranger, its axes and its cone, and a scale bar.
/// A complete SVG document.
[[nodiscard]] std::string mounting_svg(const RobotParameters&);

}  // namespace noctule::sim
