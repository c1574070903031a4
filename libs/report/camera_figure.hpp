#pragma once
/// A picture of the robot's camera with what was found in it.
#include <string>

#include "report/run_data.hpp"

namespace noctule::report {

/// SVG with the picture, halved, inside: outlines of the landmarks, their numbers and distances.
[[nodiscard]] std::string camera_figure(const CameraExample& example);

}  // namespace noctule::report
