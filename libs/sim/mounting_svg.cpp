#include "sim/mounting_svg.hpp"

#include <algorithm>
#include <sstream>

namespace noctule::sim {
namespace {

constexpr double kSize = 640.0;       // [px]
constexpr double kConeInRadii = 2.5;  // length drawn of a cone, in radii of the base
constexpr double kMarginInRadii = 0.9;

/// Text safe inside XML.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// Metres on the base to pixels: x to the right, y up.
class Canvas {
 public:
  explicit Canvas(double half_width) : scale_(0.5 * kSize / half_width) {}

  [[nodiscard]] double pixels(double length) const { return scale_ * length; }
  [[nodiscard]] std::string point(const Vector2& p) const {
    std::ostringstream out;
    out << 0.5 * kSize + scale_ * p.x() << " " << 0.5 * kSize - scale_ * p.y();
    return out.str();
  }

 private:
  double scale_;
};

void draw_cone(std::ostream& svg, const Canvas& canvas, const Pose2& sensor, double half_angle, double length) {
  const auto border = [&](double off) {
    return canvas.point(sensor * (length * Vector2(std::cos(off), std::sin(off))));
  };
  svg << "<path class=\"cone\" d=\"M " << canvas.point(sensor.position()) << " L " << border(-half_angle) << " A "
      << canvas.pixels(length) << " " << canvas.pixels(length) << " 0 0 0 " << border(half_angle) << " Z\"/>\n";
}

void draw_axis(std::ostream& svg, const Canvas& canvas, const Pose2& sensor, double length) {
  svg << "<path class=\"axis\" d=\"M " << canvas.point(sensor.position()) << " L "
      << canvas.point(sensor * Vector2(length, 0.0)) << "\"/>\n";
}

void draw_base(std::ostream& svg, const Canvas& canvas, double radius) {
  svg << "<circle class=\"base\" cx=\"" << 0.5 * kSize << "\" cy=\"" << 0.5 * kSize << "\" r=\""
      << canvas.pixels(radius) << "\"/>\n"
      << "<path class=\"heading\" d=\"M " << canvas.point({0.7 * radius, 0.0}) << " L "
      << canvas.point({0.4 * radius, 0.15 * radius}) << " L " << canvas.point({0.4 * radius, -0.15 * radius})
      << " Z\"/>\n";
}

void draw_sensor(std::ostream& svg, const Canvas& canvas, const Pose2& sensor, double radius) {
  const std::string at = canvas.point(sensor.position());
  const auto space = at.find(' ');
  svg << "<circle class=\"sensor\" cx=\"" << at.substr(0, space) << "\" cy=\"" << at.substr(space + 1) << "\" r=\""
      << canvas.pixels(0.08 * radius) << "\"/>\n";
}

/// The longest of 1, 2, 5, 10 ... cm that is no longer than the base's radius.
int scale_bar_cm(double radius) {
  int best = 1;
  for (const int cm : {1, 2, 5, 10, 20, 50, 100, 200, 500}) {
    if (0.01 * cm <= radius) best = cm;
  }
  return best;
}

void draw_texts(std::ostream& svg, const Canvas& canvas, const RobotParameters& robot, std::size_t pings) {
  const int bar = scale_bar_cm(robot.radius);
  const bool stepper = robot.sonar.mounting == Mounting::stepper;
  svg << "<text x=\"16\" y=\"28\" class=\"title\">" << escaped(robot.name) << "</text>\n<text x=\"16\" y=\"48\">";
  if (stepper) {
    svg << "stepper, " << pings << " pings at " << degrees(robot.sonar.stepper.step) << "&#176;";
  } else {
    svg << pings << " fixed rangers, fired " << (robot.sonar.firing == Firing::parallel ? "at once" : "one by one");
  }
  svg << ", half cone " << degrees(robot.sonar.half_angle) << "&#176;, " << 100.0 * robot.sonar.min_range << " to "
      << 100.0 * robot.sonar.max_range << " cm</text>\n"
      << "<path class=\"bar\" d=\"M 16 " << kSize - 20 << " h " << canvas.pixels(0.01 * bar) << "\"/>\n"
      << "<text x=\"16\" y=\"" << kSize - 28 << "\">" << bar << " cm</text>\n";
}

}  // namespace

std::string mounting_svg(const RobotParameters& robot) {
  const std::vector<Pose2> sensors = robot.sonar.beams();
  const double length = kConeInRadii * robot.radius;
  double reach = robot.radius;
  for (const Pose2& s : sensors) reach = std::max(reach, s.position().norm() + length);
  const Canvas canvas(reach + kMarginInRadii * robot.radius);

  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kSize << " " << kSize << "\" width=\"" << kSize
      << "\" height=\"" << kSize << "\">\n"
      << "<style>text{font:13px sans-serif;fill:#334}.title{font-weight:bold;font-size:16px}"
         ".base{fill:#eef1f5;stroke:#334;stroke-width:2}.heading{fill:#334}.sensor{fill:#c2410c}"
         ".cone{fill:#2563eb;fill-opacity:.12;stroke:#2563eb;stroke-opacity:.35}"
         ".axis{stroke:#2563eb;stroke-opacity:.5;fill:none}.bar{stroke:#334;stroke-width:3}</style>\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  draw_base(svg, canvas, robot.radius);
  // Of a stepper only the first cone is filled in: the others would cover each other.
  const std::size_t cones = robot.sonar.mounting == Mounting::stepper ? 1 : sensors.size();
  for (std::size_t i = 0; i < cones; ++i) draw_cone(svg, canvas, sensors[i], robot.sonar.half_angle, length);
  for (const Pose2& s : sensors) draw_axis(svg, canvas, s, length);
  for (std::size_t i = 0; i < cones; ++i) draw_sensor(svg, canvas, sensors[i], robot.radius);
  draw_texts(svg, canvas, robot, sensors.size());
  svg << "</svg>\n";
  return svg.str();
}

}  // namespace noctule::sim
