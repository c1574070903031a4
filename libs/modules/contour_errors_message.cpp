#include "modules/contour_errors_message.hpp"

#include <cmath>

#include "convert/convert.hpp"

namespace noctule::modules {
namespace {

/// Nothing that is not finite travels.
double measured(double value) {
  return std::isfinite(value) ? value : 0.0;
}

wall_error message_of(const eval::WallError& error) {
  wall_error message{};
  message.name = error.name;
  message.found = static_cast<std::int8_t>(error.found());
  message.anchor = static_cast<std::int8_t>(error.anchor);
  if (error.found()) {
    message.d_rho_m = error.rho;
    message.d_theta_rad = error.theta;
    message.d_theta_rotation_free_rad = error.theta_rotation_free;
  }
  return message;
}

cylinder_error message_of(const eval::CylinderError& error) {
  cylinder_error message{};
  message.name = error.name;
  message.found = static_cast<std::int8_t>(error.found());
  if (error.found()) {
    message.dx_m = error.centre.x();
    message.dy_m = error.centre.y();
    message.d_radius_m = error.radius;
  }
  return message;
}

}  // namespace

contour_errors contour_errors_message(const eval::ContourErrors& errors, std::int64_t utime) {
  contour_errors message{};
  message.utime = utime;
  message.frame = convert::kMapFrame;
  for (const eval::WallError& error : errors.walls) message.walls.push_back(message_of(error));
  for (const eval::CylinderError& error : errors.cylinders) message.cylinders.push_back(message_of(error));
  message.wall_count = static_cast<std::int32_t>(message.walls.size());
  message.cylinder_count = static_cast<std::int32_t>(message.cylinders.size());
  message.walls_found = errors.walls_found();
  message.walls_missed = errors.walls_missed();
  message.walls_invented = static_cast<std::int32_t>(errors.invented_walls.size());
  message.cylinders_found = errors.cylinders_found();
  message.cylinders_missed = errors.cylinders_missed();
  message.cylinders_invented = static_cast<std::int32_t>(errors.invented_cylinders.size());
  message.wall_mae_rho_m = measured(errors.other_walls.rho);
  message.wall_mae_theta_rad = measured(errors.other_walls.theta);
  message.wall_mae_theta_rotation_free_rad = measured(errors.other_walls.theta_rotation_free);
  message.cylinder_mae_m = measured(errors.cylinder_mae);
  message.cylinder_mae_radius_m = measured(errors.cylinder_mae_radius);
  return message;
}

}  // namespace noctule::modules
