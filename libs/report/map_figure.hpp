#pragma once
/// Plans: rooms, maps and paths seen from above, as SVG. Colours come from page/figure.css by class names.
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/run_data.hpp"

namespace noctule::report {

/// An axis-aligned piece of the map frame [m].
struct Extent {
  Vector2 low = Vector2::Constant(std::numeric_limits<double>::infinity());
  Vector2 high = Vector2::Constant(-std::numeric_limits<double>::infinity());
  [[nodiscard]] bool empty() const { return !(low.x() <= high.x() && low.y() <= high.y()); }
  /// Points that are not finite are ignored.
  void include(const Vector2& point);
  void include(const Vector2& centre, double radius);
};

/// Draws layer by layer, in the order of the calls, each into a group of its own class.
class MapFigure {
 public:
  /// \param width of the drawing in user units; the height follows from the extent (at most `max_height`)
  MapFigure(const Extent& extent, double width, double max_height);

  void room(const Room& room);
  /// Bands and ellipses of three standard deviations.
  void uncertainty(const ContourMap& map);
  /// Walls and cylinders; what `errors` calls invented is drawn apart.
  void contours(const ContourMap& map, const eval::ContourErrors* errors);
  void readings(std::span<const Vector2> points);
  void occupancy(const OccupancyImage& image);
  void known_landmarks(std::span<const KnownLandmark> landmarks);
  void landmarks(const LandmarkMap& map);
  void path(std::span<const eval::TimedPose> trajectory, const std::string& css_class);
  /// Three-sigma ellipses of about `count` of the estimates.
  void pose_uncertainty(std::span<const SlamEstimate> estimates, std::size_t count);
  void start(const Pose2& pose);

  /// The whole drawing with a scale bar. `standalone_style`: style sheet to embed, empty within a page.
  [[nodiscard]] std::string svg(const std::string& title, const std::string& description,
                                const std::string& standalone_style = {}) const;

 private:
  [[nodiscard]] Vector2 place(const Vector2& point) const;
  [[nodiscard]] std::string place_text(const Vector2& point) const;
  void begin_layer(const std::string& name) { body_ += "<g class=\"layer-" + name + "\">"; }
  void end_layer() { body_ += "</g>\n"; }
  void line(const Vector2& a, const Vector2& b, const std::string& css_class);
  void circle(const Vector2& centre, double radius, const std::string& css_class);
  void cross(const Vector2& centre, const std::string& css_class);
  void ellipse(const Vector2& centre, const Matrix2& covariance, const std::string& css_class);
  void band(const WallEstimate& wall);
  [[nodiscard]] std::string scale_bar() const;

  Extent extent_;
  double width_;
  double height_ = 0.0;
  double scale_ = 1.0;  // user units a metre
  Vector2 offset_ = Vector2::Zero();
  std::string body_;
};

}  // namespace noctule::report
