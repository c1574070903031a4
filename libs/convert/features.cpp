#include "convert/check.hpp"
#include "convert/convert.hpp"

namespace noctule::convert {
namespace {

reading_id to_reading(const ReadingId& value) {
  return {value.scan_seq, value.beam};
}

ReadingId from_reading(const reading_id& m, const Check& check) {
  return {check.not_negative_integer("scan_seq", m.scan_seq), check.not_negative_integer("beam", m.beam)};
}

contour_feature to_feature(const ContourFeature& value) {
  contour_feature m{};
  m.type = static_cast<std::int8_t>(value.type);
  m.track = value.track;
  m.has_wall = value.has_wall ? 1 : 0;
  m.wall_rho_m = value.wall.rho;
  m.wall_theta_rad = value.wall.theta;
  fill(m.wall_covariance_rho_theta_m_rad, value.wall_covariance);
  m.wall_log_likelihood = value.wall_log_likelihood;
  m.has_circle = value.has_circle ? 1 : 0;
  m.circle_x_m = value.circle.centre.x();
  m.circle_y_m = value.circle.centre.y();
  m.circle_radius_m = value.circle.radius;
  fill(m.circle_covariance_x_y_radius_m, value.circle_covariance);
  m.circle_log_likelihood = value.circle_log_likelihood;
  m.surface_x_m = value.surface.x();
  m.surface_y_m = value.surface.y();
  m.stops = value.stops;
  m.baseline_m = value.baseline;
  fill(m.reading_count, m.readings, value.readings, to_reading);
  return m;
}

ContourFeature from_feature(const contour_feature& m, const Check& check) {
  ContourFeature value;
  value.type = check.code("type", m.type, ContourType::ambiguous);
  value.track = m.track;
  value.has_wall = check.flag("has_wall", m.has_wall);
  value.wall = {check.finite("wall_rho_m", m.wall_rho_m), check.finite("wall_theta_rad", m.wall_theta_rad)};
  value.wall_covariance = check.covariance("wall_covariance_rho_theta_m_rad", m.wall_covariance_rho_theta_m_rad);
  value.wall_log_likelihood = check.finite("wall_log_likelihood", m.wall_log_likelihood);
  value.has_circle = check.flag("has_circle", m.has_circle);
  value.circle = {check.point("circle_x_m", m.circle_x_m, "circle_y_m", m.circle_y_m),
                  check.not_negative("circle_radius_m", m.circle_radius_m)};
  value.circle_covariance = check.covariance("circle_covariance_x_y_radius_m", m.circle_covariance_x_y_radius_m);
  value.circle_log_likelihood = check.finite("circle_log_likelihood", m.circle_log_likelihood);
  value.surface = check.point("surface_x_m", m.surface_x_m, "surface_y_m", m.surface_y_m);
  value.stops = check.not_negative_integer("stops", m.stops);
  value.baseline = check.not_negative("baseline_m", m.baseline_m);
  value.readings = check.list("reading_count", m.reading_count, "readings", m.readings, from_reading);
  return value;
}

}  // namespace

contour_features to_message(const ContourFeatures& value) {
  auto m = stamped<contour_features>(value.stamp, kBaseFrame);
  fill(m.feature_count, m.features, value.features, to_feature);
  return m;
}

ContourFeatures from_message(const contour_features& m) {
  const Check check("contour_features");
  return {check.stamp(m, kBaseFrame),
          check.list("feature_count", m.feature_count, "features", m.features, from_feature)};
}

}  // namespace noctule::convert
