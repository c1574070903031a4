#include "experiment/contour_room.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "config/config.hpp"
#include "core/error.hpp"

namespace noctule::experiment {
namespace {

/// A short way past the signs, with small pictures.
ScenarioSpec short_room(bool camera) {
  const std::string config = std::string(NOCTULE_SOURCE_DIR) + "/config/";
  std::string text = "world: {file: " + config +
                     "worlds/heptagon_signs.yaml, path: {loops: 1, waypoints_cm: [[0, 0], [100, 0]]}}\n"
                     "robot: {file: " +
                     config + "robots/paper002_camera.yaml}\n";
  if (camera) text += "camera: {file: " + config + "cameras/heptagon_signs.yaml}\n";
  return {.name = "short", .kind = "contour_room", .config = config::parse_tree(text, "test")};
}

FilterSpec pf(const std::string& parameters) {
  FilterSpec spec;
  spec.name = "pf";
  spec.parameters = "N=20" + parameters;
  return spec;
}

double value(const FilterRun& run, const std::string& metric) {
  const auto found = std::ranges::find(run.figures, metric, &eval::Metric::name);
  return found == run.figures.end() ? -1.0 : found->value;
}

TEST(ContourRoom, TheSensorsThatAFilterIsFedWithAreItsOwnAffair) {
  const ContourRoom room(short_room(true));
  const std::vector<FilterSpec> specs = {pf(";sensors=sonar"), pf(";sensors=camera"), pf(";sensors=both"), pf("")};
  for (const FilterSpec& spec : specs) EXPECT_NO_THROW(room.check(spec));
  const auto runs = room.run(3, specs);
  ASSERT_EQ(runs.size(), 4u);
  // Echoes alone: as if there were no camera, to the bit.
  const auto blind = ContourRoom(short_room(false)).run(3, std::vector{pf("")});
  for (const char* metric : {"position_rmse", "heading_rmse", "wall_mae_rho", "nees_mean"}) {
    EXPECT_EQ(value(runs[0], metric), value(blind[0], metric)) << metric;
    EXPECT_EQ(value(runs[2], metric), value(runs[3], metric)) << metric << ": both is what there is";
    EXPECT_NE(value(runs[1], metric), value(runs[2], metric)) << metric;
  }
  EXPECT_LT(value(runs[0], "landmarks_found"), 1.0);
  EXPECT_GE(value(runs[1], "landmarks_found"), 2.0);
  const auto names = room.metrics();
  for (const eval::Metric& m : runs[2].figures) {
    EXPECT_NE(std::ranges::find(names, m.name), names.end()) << m.name;
  }
}

TEST(ContourRoom, WrongSensorsAreNamed) {
  const ContourRoom room(short_room(true));
  try {
    room.check(pf(";sensors=nose"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "filter 'pf': sensors: expected sonar, camera or both, got 'nose'");
  }
  EXPECT_THROW(ContourRoom(short_room(false)).check(pf(";sensors=camera")), InputError);
  EXPECT_NO_THROW(ContourRoom(short_room(false)).check(pf(";sensors=sonar")));
}

}  // namespace
}  // namespace noctule::experiment
