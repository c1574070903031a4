/// Recorded data through reader, extractor, filter and mapper, judged by what is known of each place.
/// Usage: sweep_real_input DATA_FOLDER [first corridor seed = 1] [last = 20]. Prints Markdown.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <span>
#include <string>

#include "eval/corridor.hpp"
#include "eval/room_alignment.hpp"
#include "eval/statistics.hpp"
#include "eval/trajectory.hpp"
#include "modules/pipeline_file.hpp"

namespace {

namespace fs = std::filesystem;
using namespace noctule;

modules::PipelineParameters load(const std::string& file, const std::vector<std::string>& assignments) {
  return modules::load_pipeline(fs::path(NOCTULE_SOURCE_DIR) / "config/pipelines" / file, assignments);
}

/// What came of a recording.
struct Run {
  std::vector<UltrasonicScan> scans;
  std::vector<Pose2> given;             ///< at the scans, where the recording has truth
  std::vector<eval::TimedPose> online;  ///< estimates when they were made
  std::vector<eval::TimedPose> truth;
  PathEstimate path;
};

Run play(ObservationSource& source, const modules::PipelineParameters& p) {
  Run run;
  sensors::UltrasonicExtractor extractor(p.ultrasonic.value_or(sensors::ExtractorParameters{}));
  filters::ParticleSlam slam(p.slam.value().filter, p.seed, source.world().start_in_map);
  Pose2 given = source.world().start_in_map;
  const auto estimated = [&](std::int64_t utime) { run.online.push_back({utime, slam.estimate().pose}); };
  while (const auto observation = source.next()) {
    if (const auto* o = std::get_if<Odometry>(&*observation)) {
      extractor.predict(*o);
      slam.predict(*o);
    } else if (const auto* g = std::get_if<GroundTruth>(&*observation)) {
      given = g->base_in_map;
      run.truth.push_back({g->stamp.utime, given});
    } else if (const auto* scan = std::get_if<UltrasonicScan>(&*observation)) {
      slam.update(*scan, p.ultrasonic ? extractor.update(*scan) : ContourFeatures{});
      run.scans.push_back(*scan);
      run.given.push_back(given);
      estimated(scan->stamp.utime);
    } else if (const auto* d = std::get_if<LandmarkDetections>(&*observation)) {
      slam.update(*d);
      estimated(d->stamp.utime);
    }
  }
  run.path = slam.path();
  return run;
}

ContourMap map_along(const Run& run, std::span<const Pose2> poses, const modules::PipelineParameters& p) {
  std::vector<mapping::PosedScan> posed;
  for (std::size_t i = 0; i < run.scans.size(); ++i) posed.push_back({run.scans[i], poses[i]});
  return mapping::map_contours(posed, p.mapping.value().contours);
}

void rooms(const fs::path& data) {
  std::printf("\n### Rooms swept from one place\n\n");
  std::printf("| run | walls that could be heard | found | scored | median error cm | median error deg | invented |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  std::vector<double> rho, theta;
  int audible = 0, found = 0;
  for (const int n : {1, 3, 4, 5, 6}) {
    std::vector<std::string> set{
        "source.path=" + (data / "ultrasonic-rooms/csv" / ("Lvl_1_Room_Map_" + std::to_string(n) + ".csv")).string(),
        "source.outline=" + (data / "ultrasonic-rooms/room_outline_richards325A.csv").string()};
    if (n == 1) set.push_back("source.start=[1.38, 3.06, -127]");
    const auto p = load("ultrasonic_rooms.yaml", set);
    const auto& room = std::get<datasets::UltrasonicRoomsParameters>(p.source);
    datasets::UltrasonicRooms source(room);
    const Run run = play(source, p);
    const ContourMap map = map_along(run, std::vector<Pose2>(run.scans.size(), room.start), p);
    const Vector2 place = room.start.position();
    const auto result = eval::align_to_room(map, source.world().room.value(), {&place, 1});
    std::printf("| Room_Map_%d | %zu | %d | %d | %.1f | %.1f |", n, result.walls.size(), result.found, result.scored,
                100.0 * result.median_rho, degrees(result.median_theta));
    for (const int j : result.invented_walls) {
      const Wall& w = map.walls[static_cast<std::size_t>(j)].wall;
      std::printf(" (%.2f m, %.0f deg)", w.rho, degrees(w.theta));
    }
    std::printf(" |\n");
    audible += static_cast<int>(result.walls.size());
    found += result.found;
    for (const auto& w : result.walls) {
      if (!w.scored) continue;
      rho.push_back(std::abs(w.rho));
      theta.push_back(std::abs(w.theta));
    }
  }
  if (rho.empty()) return;
  std::printf("\nAll runs: recall %d of %d; over %zu scored walls median error %.1f cm and %.1f degrees.\n", found,
              audible, rho.size(), 100.0 * eval::quantile(rho, 0.5), degrees(eval::quantile(theta, 0.5)));
}

/// The same figures of many runs.
struct CorridorTotals {
  std::vector<double> width, parallelism, corner;
  int within = 0;  ///< runs with all three figures within their bounds
};

void corridor_row(const char* poses, int runs, const CorridorTotals& t) {
  const auto cell = [](const std::vector<double>& values, double factor) {
    if (values.empty()) return std::string("-");
    char text[80];
    std::snprintf(text, sizeof text, "%.2f (%.2f to %.2f)", factor * eval::quantile(values, 0.5),
                  factor * eval::quantile(values, 0.0), factor * eval::quantile(values, 1.0));
    return std::string(text);
  };
  std::printf("| %s | %zu of %d | %s | %s | %s | %d |\n", poses, t.corner.size(), runs, cell(t.width, 1.0).c_str(),
              cell(t.parallelism, degrees(1.0)).c_str(), cell(t.corner, degrees(1.0)).c_str(), t.within);
}

void add(CorridorTotals& t, const ContourMap& map, std::span<const Pose2> poses) {
  std::vector<Vector2> way;
  for (const Pose2& pose : poses) way.push_back(pose.position());
  const auto f = eval::corridor_figures(map, way);
  if (f.width) t.width.push_back(*f.width);
  if (f.parallelism) t.parallelism.push_back(std::abs(*f.parallelism));
  if (f.corner) t.corner.push_back(*f.corner);
  if (f.width && f.corner && std::abs(*f.width - 2.11) <= 0.05 && std::abs(*f.parallelism) <= radians(1.5) &&
      std::abs(*f.corner - 0.5 * kPi) <= radians(2.0)) {
    ++t.within;
  }
}

void corridor(const fs::path& data, int first, int last) {
  std::printf("\n### Corridor, seeds %d to %d\n\n", first, last);
  std::printf("Median (smallest to largest). Bounds: 2.11 +- 0.05 m, 1.5 degrees, 90 +- 2 degrees.\n\n");
  std::printf("| poses | all walls found | width m | not parallel by deg | corner deg | runs within all bounds |\n");
  std::printf("|---|---|---|---|---|---|\n");
  CorridorTotals slam, given;
  for (int seed = first; seed <= last; ++seed) {
    const auto p = load("sonar_corridor.yaml",
                        {"source.path=" + (data / "sonar-corridor").string(), "seed=" + std::to_string(seed)});
    auto corridor = std::get<datasets::SonarCorridorParameters>(p.source);
    corridor.noise.seed = p.seed;
    datasets::SonarCorridor source(corridor);
    const Run run = play(source, p);
    std::vector<Pose2> path;
    for (const PathPose& pose : run.path.poses) path.push_back(pose.pose);
    add(slam, map_along(run, path, p), path);
    if (seed == first) add(given, map_along(run, run.given, p), run.given);
  }
  corridor_row("SLAM", last - first + 1, slam);
  corridor_row("given", 1, given);
}

void mrclam(const fs::path& data) {
  std::printf("\n### MR.CLAM data set 6\n\n");
  std::printf("| robot | position RMSE m | after SE(2) alignment m | heading RMSE deg |\n|---|---|---|---|\n");
  for (int robot = 1; robot <= 5; ++robot) {
    const auto p =
        load("mrclam.yaml", {"source.path=" + (data / "mrclam6").string(), "source.robot=" + std::to_string(robot)});
    datasets::Mrclam source(std::get<datasets::MrclamParameters>(p.source));
    const Run run = play(source, p);
    const auto pairs = eval::associate(run.online, run.truth, 0.5);
    const eval::PoseErrors errors = eval::pose_errors(pairs);
    std::printf("| %d | %.2f | %.2f | %.1f |\n", robot, errors.position_rmse,
                eval::absolute_trajectory_error(pairs, eval::Alignment::rigid), degrees(errors.heading_rmse));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: sweep_real_input DATA_FOLDER [first corridor seed] [last corridor seed]\n");
    return 2;
  }
  const fs::path data = argv[1];
  const int first = argc > 2 ? std::atoi(argv[2]) : 1, last = argc > 3 ? std::atoi(argv[3]) : 20;
  rooms(data);
  corridor(data, first, last);
  mrclam(data);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
