#include <algorithm>

#include "convert/check.hpp"
#include "convert/convert.hpp"

namespace noctule::convert {
namespace {

wall_estimate to_wall(const WallEstimate& value) {
  wall_estimate m{};
  m.rho_m = value.wall.rho;
  m.theta_rad = value.wall.theta;
  fill(m.covariance_rho_theta_m_rad, value.covariance);
  m.begin_m = value.begin;
  m.end_m = value.end;
  m.readings = value.readings;
  m.stops = value.stops;
  return m;
}

cylinder_estimate to_cylinder(const CylinderEstimate& value) {
  cylinder_estimate m{};
  m.x_m = value.cylinder.centre.x();
  m.y_m = value.cylinder.centre.y();
  m.radius_m = value.cylinder.radius;
  fill(m.covariance_x_y_radius_m, value.covariance);
  m.viewing_angle_rad = value.viewing_angle;
  m.readings = value.readings;
  m.stops = value.stops;
  return m;
}

point_estimate to_point(const PointEstimate& value) {
  point_estimate m{};
  m.x_m = value.position.x();
  m.y_m = value.position.y();
  fill(m.covariance_x_y_m, value.covariance);
  m.readings = value.readings;
  m.stops = value.stops;
  return m;
}

landmark_estimate to_landmark(const LandmarkEstimate& value) {
  landmark_estimate m{};
  m.id = value.id;
  m.kind = static_cast<std::int8_t>(value.kind);
  std::copy_n(value.parameters.data(), 3, m.parameters_m_rad);
  fill(m.covariance_m_rad, value.covariance);
  m.observations = value.observations;
  return m;
}

WallEstimate from_wall(const wall_estimate& m, const Check& check) {
  WallEstimate value;
  value.wall = {check.not_negative("rho_m", m.rho_m), check.finite("theta_rad", m.theta_rad)};
  value.covariance = check.covariance("covariance_rho_theta_m_rad", m.covariance_rho_theta_m_rad);
  value.begin = check.finite("begin_m", m.begin_m);
  value.end = check.within("end_m", m.end_m, m.begin_m, std::numeric_limits<double>::max());
  value.readings = check.not_negative_integer("readings", m.readings);
  value.stops = check.not_negative_integer("stops", m.stops);
  return value;
}

CylinderEstimate from_cylinder(const cylinder_estimate& m, const Check& check) {
  CylinderEstimate value;
  value.cylinder = {check.point("x_m", m.x_m, "y_m", m.y_m), check.not_negative("radius_m", m.radius_m)};
  value.covariance = check.covariance("covariance_x_y_radius_m", m.covariance_x_y_radius_m);
  value.viewing_angle = check.not_negative("viewing_angle_rad", m.viewing_angle_rad);
  value.readings = check.not_negative_integer("readings", m.readings);
  value.stops = check.not_negative_integer("stops", m.stops);
  return value;
}

PointEstimate from_point(const point_estimate& m, const Check& check) {
  PointEstimate value;
  value.position = check.point("x_m", m.x_m, "y_m", m.y_m);
  value.covariance = check.covariance("covariance_x_y_m", m.covariance_x_y_m);
  value.readings = check.not_negative_integer("readings", m.readings);
  value.stops = check.not_negative_integer("stops", m.stops);
  return value;
}

LandmarkEstimate from_landmark(const landmark_estimate& m, const Check& check) {
  LandmarkEstimate value;
  value.id = m.id;
  value.kind = check.code("kind", m.kind, LandmarkKind::undecided);
  for (int i = 0; i < 3; ++i) value.parameters[i] = check.finite("parameters_m_rad", m.parameters_m_rad[i]);
  value.covariance = check.covariance("covariance_m_rad", m.covariance_m_rad);
  value.observations = check.not_negative_integer("observations", m.observations);
  return value;
}

}  // namespace

landmark_map to_message(const LandmarkMap& value) {
  auto m = stamped<landmark_map>(value.stamp, kMapFrame);
  fill(m.landmark_count, m.landmarks, value.landmarks, to_landmark);
  return m;
}

LandmarkMap from_message(const landmark_map& m) {
  const Check check("landmark_map");
  return {check.stamp(m, kMapFrame),
          check.list("landmark_count", m.landmark_count, "landmarks", m.landmarks, from_landmark)};
}

contour_map to_message(const ContourMap& value) {
  auto m = stamped<contour_map>(value.stamp, kMapFrame);
  fill(m.wall_count, m.walls, value.walls, to_wall);
  fill(m.cylinder_count, m.cylinders, value.cylinders, to_cylinder);
  fill(m.point_count, m.points, value.points, to_point);
  return m;
}

ContourMap from_message(const contour_map& m) {
  const Check check("contour_map");
  return {check.stamp(m, kMapFrame), check.list("wall_count", m.wall_count, "walls", m.walls, from_wall),
          check.list("cylinder_count", m.cylinder_count, "cylinders", m.cylinders, from_cylinder),
          check.list("point_count", m.point_count, "points", m.points, from_point)};
}

}  // namespace noctule::convert
