#include "report/map_figure.hpp"

#include <algorithm>
#include <cmath>

#include "core/symmetric_eigen.hpp"
#include "report/text.hpp"
#include "report/ticks.hpp"

namespace noctule::report {
namespace {

constexpr double kSigmas = 3.0;
constexpr double kBorder = 26.0;  // user units around the extent, for labels and line widths
constexpr double kFoot = 20.0;    // below, for the scale bar

Vector2 end_point(const Wall& wall, double along) {
  return wall.rho * wall.normal() + along * wall.tangent();
}

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + fixed(value, 2) + "\"";
}

std::string class_attribute(const std::string& name) {
  return " class=\"" + name + "\"";
}

bool contains(const std::vector<int>& indices, std::size_t i) {
  return std::find(indices.begin(), indices.end(), static_cast<int>(i)) != indices.end();
}

}  // namespace

void Extent::include(const Vector2& point) {
  if (!point.allFinite()) return;
  low = low.cwiseMin(point);
  high = high.cwiseMax(point);
}

void Extent::include(const Vector2& centre, double radius) {
  include(centre - Vector2::Constant(radius));
  include(centre + Vector2::Constant(radius));
}

MapFigure::MapFigure(const Extent& extent, double width, double max_height) : extent_(extent), width_(width) {
  if (extent_.empty()) extent_ = {Vector2::Constant(-1.0), Vector2::Constant(1.0)};
  const Vector2 size = (extent_.high - extent_.low).cwiseMax(0.1);
  scale_ = std::min((width - 2 * kBorder) / size.x(), (max_height - 2 * kBorder - kFoot) / size.y());
  height_ = size.y() * scale_ + 2 * kBorder + kFoot;
  offset_ = {0.5 * (width - size.x() * scale_), kBorder};
}

Vector2 MapFigure::place(const Vector2& point) const {
  return {offset_.x() + (point.x() - extent_.low.x()) * scale_, offset_.y() + (extent_.high.y() - point.y()) * scale_};
}

std::string MapFigure::place_text(const Vector2& point) const {
  const Vector2 p = place(point);
  return fixed(p.x(), 2) + " " + fixed(p.y(), 2);
}

void MapFigure::line(const Vector2& a, const Vector2& b, const std::string& css_class) {
  const Vector2 p = place(a), q = place(b);
  body_ += "<line" + class_attribute(css_class) + attribute("x1", p.x()) + attribute("y1", p.y()) +
           attribute("x2", q.x()) + attribute("y2", q.y()) + "/>";
}

void MapFigure::circle(const Vector2& centre, double radius, const std::string& css_class) {
  const Vector2 c = place(centre);
  body_ += "<circle" + class_attribute(css_class) + attribute("cx", c.x()) + attribute("cy", c.y()) +
           attribute("r", std::max(radius * scale_, 0.0)) + "/>";
}

void MapFigure::cross(const Vector2& centre, const std::string& css_class) {
  const Vector2 c = place(centre);
  constexpr double kArm = 4.0;
  body_ += "<path" + class_attribute(css_class) + " d=\"M" + fixed(c.x() - kArm, 2) + " " + fixed(c.y(), 2) + "h" +
           fixed(2 * kArm, 0) + "M" + fixed(c.x(), 2) + " " + fixed(c.y() - kArm, 2) + "v" + fixed(2 * kArm, 0) +
           "\"/>";
}

void MapFigure::ellipse(const Vector2& centre, const Matrix2& covariance, const std::string& css_class) {
  if (!covariance.allFinite() || !centre.allFinite()) return;
  const SymmetricEigen<2> eigen = symmetric_eigen<2>(covariance);
  const Vector2 axes = kSigmas * scale_ * eigen.values.cwiseMax(0.0).cwiseSqrt();
  const Vector2 major = eigen.vectors.col(1);
  const Vector2 c = place(centre);
  const double tilt = -degrees(std::atan2(major.y(), major.x()));  // the picture's y axis points down
  body_ += "<ellipse" + class_attribute(css_class) + attribute("rx", axes[1]) + attribute("ry", axes[0]) +
           " transform=\"translate(" + fixed(c.x(), 2) + " " + fixed(c.y(), 2) + ") rotate(" + fixed(tilt, 2) + ")\"/>";
}

void MapFigure::room(const Room& room) {
  begin_layer("truth");
  for (const RoomWall& w : room.walls) {
    line(end_point(w.wall, w.begin), end_point(w.wall, w.end), "truth-wall");
  }
  for (const RoomCylinder& c : room.cylinders) circle(c.cylinder.centre, c.cylinder.radius, "truth-cylinder");
  constexpr double kLabelDistance = 15.0;  // user units outside the wall
  for (const RoomWall& w : room.walls) {
    const Vector2 p = place(end_point(w.wall, 0.5 * (w.begin + w.end)) + kLabelDistance / scale_ * w.wall.normal());
    body_ += "<text class=\"wall-name\"" + attribute("x", p.x()) + attribute("y", p.y() + 4.0) + ">" + escape(w.name) +
             "</text>";
  }
  end_layer();
}

void MapFigure::band(const WallEstimate& w) {
  if (!w.covariance.allFinite() || !std::isfinite(w.wall.rho + w.wall.theta + w.begin + w.end)) return;
  // A point of the line at s along the tangent moves along the normal by d rho - s d theta.
  constexpr int kPieces = 12;
  std::string there, back;
  for (int i = 0; i <= kPieces; ++i) {
    const double s = std::lerp(w.begin, w.end, static_cast<double>(i) / kPieces);
    const double variance = w.covariance(0, 0) - 2.0 * s * w.covariance(0, 1) + s * s * w.covariance(1, 1);
    const Vector2 half = kSigmas * std::sqrt(std::max(variance, 0.0)) * w.wall.normal();
    const Vector2 p = end_point(w.wall, s);
    there += (i == 0 ? "M" : "L") + place_text(p + half);
    back = "L" + place_text(p - half) + back;
  }
  body_ += "<path class=\"band\" d=\"" + there + back + "Z\"/>";
}

void MapFigure::uncertainty(const ContourMap& map) {
  begin_layer("uncertainty");
  for (const WallEstimate& w : map.walls) band(w);
  for (const CylinderEstimate& c : map.cylinders) {
    const double sigma = std::sqrt(std::max(c.covariance(2, 2), 0.0));
    if (!std::isfinite(sigma + c.cylinder.radius) || !c.cylinder.centre.allFinite()) continue;
    const Vector2 p = place(c.cylinder.centre);
    body_ += "<circle class=\"ring\"" + attribute("cx", p.x()) + attribute("cy", p.y()) +
             attribute("r", std::max(c.cylinder.radius * scale_, 0.0)) +
             attribute("stroke-width", 2 * kSigmas * sigma * scale_) + "/>";
    ellipse(c.cylinder.centre, c.covariance.topLeftCorner<2, 2>(), "band");
  }
  for (const PointEstimate& p : map.points) ellipse(p.position, p.covariance, "band");
  end_layer();
}

void MapFigure::contours(const ContourMap& map, const eval::ContourErrors* errors) {
  begin_layer("estimate");
  for (std::size_t i = 0; i < map.walls.size(); ++i) {
    const WallEstimate& w = map.walls[i];
    if (!std::isfinite(w.wall.rho + w.wall.theta + w.begin + w.end)) continue;
    const bool invented = errors != nullptr && contains(errors->invented_walls, i);
    line(end_point(w.wall, w.begin), end_point(w.wall, w.end), invented ? "wall invented" : "wall");
  }
  for (std::size_t i = 0; i < map.cylinders.size(); ++i) {
    const Cylinder& c = map.cylinders[i].cylinder;
    if (!std::isfinite(c.radius) || !c.centre.allFinite()) continue;
    const bool invented = errors != nullptr && contains(errors->invented_cylinders, i);
    circle(c.centre, c.radius, invented ? "cylinder invented" : "cylinder");
    circle(c.centre, 1.5 / scale_, "centre");
  }
  for (const PointEstimate& p : map.points) {
    if (p.position.allFinite()) cross(p.position, "corner");
  }
  end_layer();
}

void MapFigure::readings(std::span<const Vector2> points) {
  begin_layer("readings");
  body_ += "<path class=\"readings\" d=\"";
  for (const Vector2& p : points) {
    const Vector2 q = p.allFinite() ? place(p) : Vector2(-1.0, -1.0);
    if (q.x() >= 0.0 && q.x() <= width_ && q.y() >= 0.0 && q.y() <= height_) {
      body_ += "M" + fixed(q.x(), 1) + " " + fixed(q.y(), 1) + "h0";
    }
  }
  body_ += "\"/>";
  end_layer();
}

void MapFigure::occupancy(const OccupancyImage& image) {
  begin_layer("occupancy");
  constexpr int kLevels = 4;  // shades from free to occupied
  const auto level = [&](int column, int row) {
    const float p = image.occupancy[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.columns) +
                                    static_cast<std::size_t>(column)];
    return p >= 0.0F && p <= 1.0F ? std::min(static_cast<int>(p * kLevels), kLevels - 1) : -1;
  };
  std::vector<std::string> runs(kLevels);
  const double cell = image.resolution * scale_;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0, next = 0; column < image.columns; column = next) {
      const int shade = level(column, row);
      for (next = column + 1; next < image.columns && level(next, row) == shade; ++next) {
      }
      if (shade < 0) continue;
      const Vector2 top_left = image.origin + image.resolution * Vector2(column, row + 1);
      const std::string width = fixed((next - column) * cell, 1);
      runs[static_cast<std::size_t>(shade)] +=
          "M" + place_text(top_left) + "h" + width + "v" + fixed(cell, 1) + "h-" + width + "z";
    }
  }
  for (int i = 0; i < kLevels; ++i) {
    body_ += "<path class=\"occupancy-" + std::to_string(i) + "\" d=\"" + runs[static_cast<std::size_t>(i)] + "\"/>";
  }
  end_layer();
}

void MapFigure::known_landmarks(std::span<const KnownLandmark> landmarks) {
  begin_layer("truth");
  for (const KnownLandmark& l : landmarks) circle(l.position, 6.0 / scale_, "known-landmark");
  end_layer();
}

void MapFigure::landmarks(const LandmarkMap& map) {
  begin_layer("uncertainty");
  for (const LandmarkEstimate& l : map.landmarks) {
    if (l.kind != LandmarkKind::point) continue;
    ellipse(l.parameters.head<2>(), l.covariance.topLeftCorner<2, 2>(), "band");
  }
  end_layer();
  begin_layer("estimate");
  for (const LandmarkEstimate& l : map.landmarks) {
    if (l.kind == LandmarkKind::point && l.parameters.allFinite()) cross(l.parameters.head<2>(), "landmark");
  }
  end_layer();
}

void MapFigure::path(std::span<const eval::TimedPose> trajectory, const std::string& css_class) {
  begin_layer(css_class);
  body_ += "<path class=\"path " + css_class + "\" d=\"";
  bool draw = false;
  Vector2 last = Vector2::Constant(-1e9);
  for (const eval::TimedPose& p : trajectory) {
    if (!p.pose.finite()) {
      draw = false;
      continue;
    }
    const Vector2 q = place(p.pose.position());
    constexpr double kFinest = 0.4;  // user units: nearer points would only make the file larger
    if (draw && (q - last).norm() < kFinest) continue;
    body_ += (draw ? "L" : "M") + fixed(q.x(), 1) + " " + fixed(q.y(), 1);
    last = q;
    draw = true;
  }
  body_ += "\"/>";
  end_layer();
}

void MapFigure::pose_uncertainty(std::span<const SlamEstimate> estimates, std::size_t count) {
  begin_layer("uncertainty");
  const std::size_t step = std::max<std::size_t>(1, estimates.size() / std::max<std::size_t>(count, 1));
  for (std::size_t i = 0; i < estimates.size(); i += step) {
    ellipse(estimates[i].pose.position(), estimates[i].covariance.topLeftCorner<2, 2>(), "pose-ellipse");
  }
  end_layer();
}

void MapFigure::start(const Pose2& pose) {
  if (!pose.finite()) return;
  const Vector2 p = place(pose.position());
  begin_layer("start");
  body_ += "<path class=\"start\" transform=\"translate(" + fixed(p.x(), 2) + " " + fixed(p.y(), 2) + ") rotate(" +
           fixed(-degrees(pose.yaw), 2) + ")\" d=\"M9 0L-6 6L-3 0L-6 -6Z\"/>";
  end_layer();
}

std::string MapFigure::scale_bar() const {
  constexpr double kWanted = 60.0;  // user units
  const double length = nice_step(kWanted / scale_);
  const std::string label = length < 0.995 ? fixed(100.0 * length, 0) + " cm" : fixed(length, 0) + " m";
  const Vector2 a(8.0, height_ - 6.0);
  return "<g class=\"scale\"><path d=\"M" + fixed(a.x(), 2) + " " + fixed(a.y() - 4.0, 2) + "v4h" +
         fixed(length * scale_, 2) + "v-4\"/><text" + attribute("x", a.x() + length * scale_ + 6.0) +
         attribute("y", a.y()) + ">" + label + "</text></g>\n";
}

std::string MapFigure::svg(const std::string& title, const std::string& description,
                           const std::string& standalone_style) const {
  const std::string size = fixed(width_, 0) + " " + fixed(std::ceil(height_), 0);
  std::string out = "<svg class=\"map\" role=\"img\" viewBox=\"0 0 " + size + "\"";
  if (!standalone_style.empty()) {
    out += " xmlns=\"http://www.w3.org/2000/svg\" width=\"" + fixed(width_, 0) + "\" height=\"" +
           fixed(std::ceil(height_), 0) + "\"";
  }
  out += "><title>" + escape(title) + "</title><desc>" + escape(description) + "</desc>\n";
  if (!standalone_style.empty()) {
    out += "<style>" + standalone_style + "</style><rect class=\"sheet\" width=\"100%\" height=\"100%\"/>\n";
  }
  return out + body_ + scale_bar() + "</svg>\n";
}

}  // namespace noctule::report
