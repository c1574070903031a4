#include "experiment/path_mapper.hpp"

#include "filters/slam/make_slam_filter.hpp"

namespace noctule::experiment {
namespace {

filters::FastSlam1Parameters one_particle() {
  filters::FastSlam1Parameters parameters;
  parameters.particles = 1;
  return parameters;
}

}  // namespace

PathMapper::PathMapper(const Pose2& start) : filter_(filters::make_slam_filter(one_particle(), 0, start)), at_(start) {}

PathMapper::~PathMapper() = default;

void PathMapper::take(const LandmarkDetections& sightings, const Pose2& pose) {
  filter_->predict({.stamp = sightings.stamp, .increment = between(at_, pose)});
  filter_->update(sightings);
  at_ = pose;
}

LandmarkMap PathMapper::map() const {
  return filter_->map();
}

}  // namespace noctule::experiment
