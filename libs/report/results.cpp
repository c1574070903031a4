#include "report/results.hpp"

#include <cmath>

#include "eval/contour_file.hpp"
#include "eval/landmark_file.hpp"
#include "eval/number_text.hpp"
#include "eval/tum.hpp"
#include "report/files.hpp"
#include "report/json.hpp"
#include "report/occupancy_image.hpp"
#include "report/page.hpp"
#include "report/pose_series.hpp"
#include "report/run_plans.hpp"

namespace noctule::report {
namespace {

std::string metrics_csv(const std::vector<eval::Metric>& metrics) {
  std::string text = "name,value,unit\n";
  for (const eval::Metric& m : metrics) {
    text += m.name + "," + (std::isfinite(m.value) ? eval::shortest(m.value) : "") + "," + m.unit + "\n";
  }
  return text;
}

std::vector<eval::TimedPose> final_path(const RunData& data) {
  std::vector<eval::TimedPose> path;
  for (const PathPose& p : data.path.poses) path.push_back({p.utime, p.pose});
  return path;
}

std::string estimated_landmarks(const LandmarkMap& map) {
  std::vector<KnownLandmark> points;
  for (const LandmarkEstimate& l : map.landmarks) {
    if (l.kind == LandmarkKind::point && l.parameters.allFinite()) points.push_back({l.id, l.parameters.head<2>()});
  }
  return points.empty() ? std::string() : eval::landmarks_csv(points);
}

/// Metrics that could not be measured are written as null; the reader is told which.
RunData with_notes(const RunData& data) {
  RunData noted = data;
  std::string names;
  for (const eval::Metric& m : data.metrics) {
    if (!std::isfinite(m.value)) names += (names.empty() ? "" : ", ") + m.name;
  }
  if (!names.empty()) noted.notes.push_back("Not a finite number, null in metrics.json: " + names + ".");
  return noted;
}

}  // namespace

void write_results(const RunData& data, const std::filesystem::path& dir) {
  prepare_results(dir);
  const auto write = [&](const char* name, const std::string& content) { write_file(dir / name, content); };
  // What this run does not have must not stay behind from an earlier one.
  const auto write_or_remove = [&](const char* name, const std::string& content) {
    std::error_code ignored;
    if (content.empty()) {
      std::filesystem::remove(dir / name, ignored);
    } else {
      write(name, content);
    }
  };
  write("config.yaml", data.config_yaml);
  write("metrics.json", metrics_json(data.metrics));
  write("metrics.csv", metrics_csv(data.metrics));
  write("timing.json", metrics_json(data.timing));
  write("trajectory.tum", eval::to_tum(filter_trajectory(data)));
  write_or_remove("path.tum", eval::to_tum(final_path(data)));
  write_or_remove("ground_truth.tum", eval::to_tum(data.truth));
  write_or_remove("dead_reckoning.tum", eval::to_tum(data.dead_reckoning));
  const KnownWorld& world = data.world;
  write_or_remove("fixes.csv", world.fixes.empty() ? "" : eval::fixes_csv(world.fixes));
  write_or_remove("landmarks.csv", estimated_landmarks(data.landmarks));
  write_or_remove("known_landmarks.csv", world.landmarks.empty() ? "" : eval::landmarks_csv(world.landmarks));
  const Room mapped = data.contours ? eval::as_room(data.contours->map) : Room{}, known = world.room.value_or(Room{});
  write_or_remove("walls.csv", data.contours ? eval::walls_csv(mapped.walls) : "");
  write_or_remove("cylinders.csv", data.contours ? eval::cylinders_csv(mapped.cylinders) : "");
  write_or_remove("known_walls.csv", world.room ? eval::walls_csv(known.walls) : "");
  write_or_remove("known_cylinders.csv", world.room ? eval::cylinders_csv(known.cylinders) : "");
  write("map.svg", map_svg(data));
  write_or_remove("map.pgm", data.occupancy ? to_pgm(*data.occupancy) : "");
  write_or_remove("map.yaml", data.occupancy ? to_map_yaml(*data.occupancy, "map.pgm") : "");
  write("report.html", page(with_notes(data)));
}

}  // namespace noctule::report
