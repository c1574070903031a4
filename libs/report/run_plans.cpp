#include "report/run_plans.hpp"

#include "eval/statistics.hpp"
#include "report/assets.hpp"
#include "report/map_figure.hpp"
#include "report/pose_series.hpp"

namespace noctule::report {
namespace {

constexpr double kPlanWidth = 560.0, kMaxPlanHeight = 560.0;

void include_trajectory(const std::vector<eval::TimedPose>& trajectory, Extent& extent) {
  for (const eval::TimedPose& p : trajectory) extent.include(p.pose.position());
}

void include_room(const Room& room, Extent& extent) {
  for (const RoomWall& w : room.walls) {
    for (const double along : {w.begin, w.end}) extent.include(w.wall.rho * w.wall.normal() + along * w.wall.tangent());
  }
  for (const RoomCylinder& c : room.cylinders) extent.include(c.cylinder.centre, c.cylinder.radius);
}

void include_contours(const ContourMap& map, Extent& extent) {
  for (const WallEstimate& w : map.walls) {
    for (const double along : {w.begin, w.end}) extent.include(w.wall.rho * w.wall.normal() + along * w.wall.tangent());
  }
  for (const CylinderEstimate& c : map.cylinders) extent.include(c.cylinder.centre, c.cylinder.radius);
}

/// Where most of the readings lie: a few far ones must not shrink the rest.
void include_readings(const std::vector<Vector2>& points, Extent& extent) {
  std::vector<double> x, y;
  for (const Vector2& p : points) {
    if (!p.allFinite()) continue;
    x.push_back(p.x());
    y.push_back(p.y());
  }
  if (x.empty()) return;
  constexpr double kTail = 0.02;
  for (const double part : {kTail, 1.0 - kTail}) extent.include({eval::quantile(x, part), eval::quantile(y, part)});
}

/// What all plans of the run show, so that they can be compared: the known world and the truth, or else what was found.
Extent extent_of(const RunData& data) {
  Extent extent;
  if (data.world.room) include_room(*data.world.room, extent);
  for (const KnownLandmark& l : data.world.landmarks) extent.include(l.position);
  include_trajectory(data.truth, extent);
  include_trajectory(filter_trajectory(data), extent);
  if (data.world.room) return extent;
  if (data.contours) include_contours(data.contours->map, extent);
  include_readings(data.direct_points, extent);
  return extent;
}

std::vector<eval::TimedPose> path_of(const RunData& data) {
  if (data.path.poses.empty()) return filter_trajectory(data);
  std::vector<eval::TimedPose> path;
  for (const PathPose& p : data.path.poses) path.push_back({p.utime, p.pose});
  return path;
}

MapFigure map_figure(const RunData& data, bool with_readings) {
  MapFigure figure(extent_of(data), kPlanWidth, kMaxPlanHeight);
  if (data.world.room) figure.room(*data.world.room);
  figure.known_landmarks(data.world.landmarks);
  if (with_readings) figure.readings(data.direct_points);
  if (data.contours) figure.uncertainty(data.contours->map);
  figure.path(path_of(data), "estimate-path");
  if (data.contours) {
    const auto& errors = data.contours->errors;
    figure.contours(data.contours->map, errors ? &*errors : nullptr);
  }
  figure.landmarks(data.landmarks);
  figure.start(data.world.start_in_map);
  return figure;
}

}  // namespace

std::string map_plan(const RunData& data) {
  return map_figure(data, true)
      .svg("Estimated map",
           "Plan of the estimated contours and landmarks with three-sigma bounds, over the known "
           "ones where these are known, and the robot's path.");
}

std::string map_svg(const RunData& data) {
  return map_figure(data, false)
      .svg(data.title, "Map estimated by Noctule, three-sigma bounds, path; the known world in grey.", kFigureStyle);
}

std::string readings_plan(const RunData& data) {
  MapFigure figure(extent_of(data), kPlanWidth, kMaxPlanHeight);
  if (data.world.room) figure.room(*data.world.room);
  figure.readings(data.direct_points);
  figure.path(data.dead_reckoning, "odometry-path");
  figure.start(data.world.start_in_map);
  return figure.svg("Direct map", "Every reading on the axis of its beam, along dead reckoning, without a filter.");
}

std::string contour_plan(const RunData& data, const ContourResult& contours, const std::string& title) {
  MapFigure figure(extent_of(data), kPlanWidth, kMaxPlanHeight);
  if (data.world.room) figure.room(*data.world.room);
  figure.uncertainty(contours.map);
  figure.contours(contours.map, contours.errors ? &*contours.errors : nullptr);
  figure.start(data.world.start_in_map);
  return figure.svg(title, "Plan of the contours that the mapper made of this path, with three-sigma bounds.");
}

std::string path_plan(const RunData& data) {
  Extent extent = extent_of(data);
  if (!data.world.room) include_trajectory(data.dead_reckoning, extent);
  MapFigure figure(extent, kPlanWidth, kMaxPlanHeight);
  if (data.world.room) figure.room(*data.world.room);
  figure.path(data.truth, "truth-path");
  figure.path(data.dead_reckoning, "odometry-path");
  constexpr std::size_t kEllipses = 40;
  figure.pose_uncertainty(data.estimates, kEllipses);
  figure.path(filter_trajectory(data), "estimate-path");
  figure.start(data.world.start_in_map);
  return figure.svg("Path", "Plan of the estimated path with three-sigma ellipses, dead reckoning and the true path.");
}

std::string occupancy_plan(const RunData& data) {
  constexpr int kMostCells = 400'000;
  if (!data.occupancy || data.occupancy->columns * data.occupancy->rows > kMostCells) return {};
  MapFigure figure(extent_of(data), kPlanWidth, kMaxPlanHeight);
  figure.occupancy(*data.occupancy);
  figure.path(path_of(data), "estimate-path");
  return figure.svg("Occupancy grid", "Plan of the occupancy probabilities: dark cells are occupied, light ones free.");
}

}  // namespace noctule::report
