#include "sim/mounting_svg.hpp"

#include <gtest/gtest.h>

#include "unit/sim/heptagon.hpp"

namespace noctule::sim {
namespace {

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(MountingSvg, DrawsAConeAndAnAxisForEachFixedRanger) {
  RobotParameters robot = test::paper002();
  robot.sonar.mounting = Mounting::fixed;
  for (int i = 0; i < 6; ++i) robot.sonar.mounts.push_back({Pose2{0.05, 0.0, radians(60.0 * i)}});
  const std::string svg = mounting_svg(robot);
  EXPECT_EQ(count(svg, "class=\"base\""), 1);
  EXPECT_EQ(count(svg, "class=\"cone\""), 6);
  EXPECT_EQ(count(svg, "class=\"axis\""), 6);
  EXPECT_EQ(count(svg, "class=\"sensor\""), 6);
  EXPECT_NE(svg.find("6 fixed rangers, fired one by one"), std::string::npos);
}

TEST(MountingSvg, DrawsEveryDirectionOfAStepper) {
  const std::string svg = mounting_svg(test::paper002());
  EXPECT_EQ(count(svg, "class=\"axis\""), 60);
  EXPECT_EQ(count(svg, "class=\"cone\""), 1);
  EXPECT_NE(svg.find("60 pings at 6&#176;, half cone 15&#176;, 2 to 400 cm"), std::string::npos);
}

TEST(MountingSvg, IsOneDocumentWithTheNameEscaped) {
  RobotParameters robot = test::paper002();
  robot.name = "a < b & c";
  const std::string svg = mounting_svg(robot);
  EXPECT_TRUE(svg.starts_with("<svg xmlns="));
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find("a &lt; b &amp; c"), std::string::npos);
}

TEST(MountingSvg, ForwardIsToTheRight) {
  RobotParameters robot = test::paper002();
  robot.sonar.mounting = Mounting::fixed;
  robot.sonar.mounts = {{Pose2{0.05, 0.0, 0.0}}};
  const std::string svg = mounting_svg(robot);
  const auto at = svg.find("class=\"sensor\" cx=\"") + 19;
  EXPECT_GT(std::stod(svg.substr(at)), 320.0);
}

}  // namespace
}  // namespace noctule::sim
