#include "convert/check.hpp"
#include "convert/convert.hpp"

namespace noctule::convert {
namespace {

path_pose to_path_pose(const PathPose& value) {
  return {value.scan_seq, value.utime, value.pose.x, value.pose.y, value.pose.yaw};
}

PathPose from_path_pose(const path_pose& m, const Check& check) {
  return {check.not_negative_integer("scan_seq", m.scan_seq), m.utime,
          check.pose("x_m", m.x_m, "y_m", m.y_m, "yaw_rad", m.yaw_rad)};
}

weighted_pose to_weighted_pose(const WeightedPose& value) {
  return {value.pose.x, value.pose.y, value.pose.yaw, value.weight};
}

WeightedPose from_weighted_pose(const weighted_pose& m, const Check& check) {
  return {check.pose("x_m", m.x_m, "y_m", m.y_m, "yaw_rad", m.yaw_rad), check.not_negative("weight", m.weight)};
}

}  // namespace

slam_estimate to_message(const SlamEstimate& value) {
  auto m = stamped<slam_estimate>(value.stamp, kMapFrame);
  m.x_m = value.pose.x;
  m.y_m = value.pose.y;
  m.yaw_rad = value.pose.yaw;
  fill(m.covariance_x_y_yaw_m_rad, value.covariance);
  m.particle_count = value.particles;
  m.effective_sample_size = value.effective_sample_size;
  m.distinct_particles = value.distinct_particles;
  m.distinct_ancestors = value.distinct_ancestors;
  m.resampled = value.resampled ? 1 : 0;
  m.noise_scale = value.noise_scale;
  m.nis = value.nis;
  return m;
}

SlamEstimate from_message(const slam_estimate& m) {
  const Check check("slam_estimate");
  SlamEstimate value;
  value.stamp = check.stamp(m, kMapFrame);
  value.pose = check.pose("x_m", m.x_m, "y_m", m.y_m, "yaw_rad", m.yaw_rad);
  value.covariance = check.covariance("covariance_x_y_yaw_m_rad", m.covariance_x_y_yaw_m_rad);
  value.particles = check.not_negative_integer("particle_count", m.particle_count);
  value.effective_sample_size = check.not_negative("effective_sample_size", m.effective_sample_size);
  value.distinct_particles = check.not_negative_integer("distinct_particles", m.distinct_particles);
  value.distinct_ancestors = check.not_negative_integer("distinct_ancestors", m.distinct_ancestors);
  value.resampled = check.flag("resampled", m.resampled);
  value.noise_scale = check.not_negative("noise_scale", m.noise_scale);
  value.nis = check.not_negative("nis", m.nis);
  return value;
}

path_estimate to_message(const PathEstimate& value) {
  auto m = stamped<path_estimate>(value.stamp, kMapFrame);
  fill(m.pose_count, m.poses, value.poses, to_path_pose);
  return m;
}

PathEstimate from_message(const path_estimate& m) {
  const Check check("path_estimate");
  return {check.stamp(m, kMapFrame), check.list("pose_count", m.pose_count, "poses", m.poses, from_path_pose)};
}

particles to_message(const ParticleCloud& value) {
  auto m = stamped<particles>(value.stamp, kMapFrame);
  fill(m.particle_count, m.poses, value.particles, to_weighted_pose);
  return m;
}

ParticleCloud from_message(const particles& m) {
  const Check check("particles");
  return {check.stamp(m, kMapFrame),
          check.list("particle_count", m.particle_count, "poses", m.poses, from_weighted_pose)};
}

}  // namespace noctule::convert
