/// Recorded data through reader, extractor, filter and mapper, judged by what is known of each place.
/// Usage: sweep_real_input DATA_FOLDER [first corridor seed = 1] [last = 20]. Prints Markdown.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

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
  std::vector<Pose2> dead_reckoning;    ///< at the scans
  std::vector<eval::TimedPose> online;  ///< estimates when they were made
  std::vector<eval::TimedPose> truth;
  std::vector<Pose2> path;  ///< the best particle's, at the scans or sightings
};

Run play(ObservationSource& source, const modules::PipelineParameters& p) {
  Run run;
  sensors::UltrasonicExtractor extractor(p.ultrasonic.value_or(sensors::ExtractorParameters{}));
  const auto slam = filters::make_slam_filter(p.slam.value().filter, p.seed, source.world().start_in_map);
  Pose2 given = source.world().start_in_map, dead_reckoning = given;
  const auto estimated = [&](std::int64_t utime) { run.online.push_back({utime, slam->estimate().pose}); };
  while (const auto observation = source.next()) {
    if (const auto* o = std::get_if<Odometry>(&*observation)) {
      extractor.predict(*o);
      slam->predict(*o);
      dead_reckoning = dead_reckoning * o->increment;
    } else if (const auto* g = std::get_if<GroundTruth>(&*observation)) {
      given = g->base_in_map;
      run.truth.push_back({g->stamp.utime, given});
    } else if (const auto* scan = std::get_if<UltrasonicScan>(&*observation)) {
      slam->update(*scan, p.ultrasonic ? extractor.update(*scan) : ContourFeatures{});
      run.scans.push_back(*scan);
      run.given.push_back(given);
      run.dead_reckoning.push_back(dead_reckoning);
      estimated(scan->stamp.utime);
    } else if (const auto* d = std::get_if<LandmarkDetections>(&*observation)) {
      slam->update(*d);
      estimated(d->stamp.utime);
    }
  }
  for (const PathPose& pose : slam->path().poses) run.path.push_back(pose.pose);
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

std::string median_and_range(const std::vector<double>& values, double factor = 1.0) {
  if (values.empty()) return "-";
  const auto at = [&](double p) { return factor * eval::quantile(values, p); };
  char text[80];
  std::snprintf(text, sizeof text, "%.2f (%.2f to %.2f)", at(0.5), at(0.0), at(1.0));
  return text;
}

/// The same figures of many runs.
struct CorridorTotals {
  std::vector<double> width, parallelism, corner;
  int width_within = 0, parallelism_within = 0, corner_within = 0, all_within = 0;  ///< runs within the bounds
};

void corridor_row(const char* poses, int runs, const CorridorTotals& t) {
  std::printf("| %s | %zu of %d | %s | %d | %s | %d | %s | %d | %d |\n", poses, t.corner.size(), runs,
              median_and_range(t.width).c_str(), t.width_within, median_and_range(t.parallelism, degrees(1.0)).c_str(),
              t.parallelism_within, median_and_range(t.corner, degrees(1.0)).c_str(), t.corner_within, t.all_within);
}

void add(CorridorTotals& t, const ContourMap& map, std::span<const Pose2> poses) {
  std::vector<Vector2> way;
  for (const Pose2& pose : poses) way.push_back(pose.position());
  const auto f = eval::corridor_figures(map, way);
  if (f.width) t.width.push_back(*f.width);
  if (f.parallelism) t.parallelism.push_back(std::abs(*f.parallelism));
  if (f.corner) t.corner.push_back(*f.corner);
  const bool width = f.width && std::abs(*f.width - 2.11) <= 0.05;
  const bool parallelism = f.parallelism && std::abs(*f.parallelism) <= radians(1.5);
  const bool corner = f.corner && std::abs(*f.corner - 0.5 * kPi) <= radians(2.0);
  t.width_within += width;
  t.parallelism_within += parallelism;
  t.corner_within += corner;
  t.all_within += width && parallelism && corner;
}

void corridor(const fs::path& data, int first, int last) {
  std::printf("\n### Corridor, seeds %d to %d\n\n", first, last);
  std::printf("Median (smallest to largest), and runs within 2.11 +- 0.05 m, 1.5 degrees, 90 +- 2 degrees, all.\n\n");
  std::printf(
      "| poses | all walls found | width m | within | not parallel by deg | within | corner deg | within | "
      "all within |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|\n");
  CorridorTotals slam, dead_reckoning, given;
  for (int seed = first; seed <= last; ++seed) {
    const auto p = load("sonar_corridor.yaml",
                        {"source.path=" + (data / "sonar-corridor").string(), "seed=" + std::to_string(seed)});
    auto corridor = std::get<datasets::SonarCorridorParameters>(p.source);
    corridor.noise.seed = p.seed;
    datasets::SonarCorridor source(corridor);
    const Run run = play(source, p);
    add(slam, map_along(run, run.path, p), run.path);
    add(dead_reckoning, map_along(run, run.dead_reckoning, p), run.dead_reckoning);
    if (seed == first) add(given, map_along(run, run.given, p), run.given);
  }
  corridor_row("SLAM", last - first + 1, slam);
  corridor_row("dead reckoning", last - first + 1, dead_reckoning);
  corridor_row("as given, no noise", 1, given);
}

void mrclam(const fs::path& data) {
  std::printf("\n### MR.CLAM data set 6\n\n");
  std::printf("Known identities, 200 particles, seeds 1 to 5: median (smallest to largest).\n\n");
  std::printf("| robot | position RMSE m | after SE(2) alignment m | heading RMSE deg |\n|---|---|---|---|\n");
  for (int robot = 1; robot <= 5; ++robot) {
    std::vector<double> position, aligned, heading;
    for (int seed = 1; seed <= 5; ++seed) {
      const auto p = load("mrclam.yaml", {"source.path=" + (data / "mrclam6").string(),
                                          "source.robot=" + std::to_string(robot), "seed=" + std::to_string(seed)});
      datasets::Mrclam source(std::get<datasets::MrclamParameters>(p.source));
      const Run run = play(source, p);
      const auto pairs = eval::associate(run.online, run.truth, 0.5);
      const eval::PoseErrors errors = eval::pose_errors(pairs);
      position.push_back(errors.position_rmse);
      aligned.push_back(eval::absolute_trajectory_error(pairs, eval::Alignment::rigid));
      heading.push_back(errors.heading_rmse);
    }
    std::printf("| %d | %s | %s | %s |\n", robot, median_and_range(position).c_str(), median_and_range(aligned).c_str(),
                median_and_range(heading, degrees(1.0)).c_str());
  }
}

/// Cells of 10 cm that returns fall into: the fewer, the better one surface is heard at one place.
std::size_t cells(std::span<const UltrasonicScan> scans, std::span<const Pose2> poses) {
  constexpr double kCell = 0.1;
  std::vector<mapping::PosedScan> posed;
  for (std::size_t i = 0; i < scans.size(); ++i) posed.push_back({scans[i], poses[i]});
  std::set<std::pair<int, int>> hit;
  for (const Vector2& p : mapping::direct_points(posed)) {
    hit.emplace(static_cast<int>(std::floor(p.x() / kCell)), static_cast<int>(std::floor(p.y() / kCell)));
  }
  return hit.size();
}

void sena() {
  std::printf("\n### SENA, virtual ring, seeds 1 to 5\n\n");
  const auto load_seed = [](int seed) { return load("sena.yaml", {"seed=" + std::to_string(seed)}); };
  auto rawlog = std::get<datasets::RawlogParameters>(load_seed(1).source);
  if (!fs::exists(rawlog.path)) {
    std::printf("%s is not there.\n", rawlog.path.c_str());
    return;
  }
  rawlog.ring = {.sensors = 170, .half_angle = radians(0.6), .min_range = 0.1, .max_range = 15.0};  // nearly the laser
  datasets::RawlogSource laser(rawlog);
  std::vector<UltrasonicScan> returns;
  while (const auto observation = laser.next()) {
    if (const auto* scan = std::get_if<UltrasonicScan>(&*observation)) returns.push_back(*scan);
  }
  std::vector<double> filtered;
  std::size_t unfiltered = 0;
  for (int seed = 1; seed <= 5; ++seed) {
    const auto p = load_seed(seed);
    datasets::RawlogSource source(std::get<datasets::RawlogParameters>(p.source));
    const Run run = play(source, p);
    filtered.push_back(static_cast<double>(cells(returns, run.path)));
    unfiltered = cells(returns, run.dead_reckoning);
  }
  std::printf(
      "Cells of 10 cm that the laser's own returns fall into: along dead reckoning %zu, along the filter's path "
      "%.0f (%.0f to %.0f).\n",
      unfiltered, eval::quantile(filtered, 0.5), eval::quantile(filtered, 0.0), eval::quantile(filtered, 1.0));
}

void bigwheel(const fs::path& data) {
  std::printf("\n### Big Wheel Bot in a garden\n\n");
  std::printf("| file | way m | from start to end, dead reckoning m | the same, filter m |\n|---|---|---|---|\n");
  for (const char* file : {"Garden_small.txt", "Garden_27_03_20.txt", "Garden_10_04_20.txt"}) {
    const auto p = load("sonar_bigwheel.yaml", {"source.path=" + (data / "sonar-bigwheel" / file).string()});
    datasets::SonarBigwheel source(std::get<datasets::SonarBigwheelParameters>(p.source));
    const Run run = play(source, p);
    double way = 0.0;
    for (std::size_t i = 1; i < run.dead_reckoning.size(); ++i) {
      way += (run.dead_reckoning[i].position() - run.dead_reckoning[i - 1].position()).norm();
    }
    std::printf("| %s | %.0f | %.2f | %.2f |\n", file, way, run.dead_reckoning.back().position().norm(),
                run.path.back().position().norm());
  }
}

/// Median difference of the ranges that two scans of a ring have in common [m]; NaN where these are fewer than half.
double difference(const UltrasonicScan& a, const UltrasonicScan& b) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.beams.size(); ++i) {
    if (a.beams[i].echo != Echo::hit || b.beams[i].echo != Echo::hit) continue;
    differences.push_back(std::abs(a.beams[i].range - b.beams[i].range));
  }
  return 2 * differences.size() < a.beams.size() ? std::nan("") : eval::quantile(differences, 0.5);
}

void scitos(const fs::path& data) {
  std::printf("\n### SCITOS G5, ring of 24\n\n");
  datasets::SonarScitos24 source({.path = data / "sonar-scitos24/sensor_readings_24.data"});
  std::vector<UltrasonicScan> scans;
  while (const auto observation = source.next()) scans.push_back(std::get<UltrasonicScan>(*observation));
  constexpr std::size_t kSecond = 9, kOtherRound = 60 * kSecond;  // scans
  std::vector<double> next, other_round;
  for (std::size_t i = 0; i + kSecond < scans.size(); i += kSecond) {
    if (const double d = difference(scans[i], scans[i + 1]); d >= 0.0) next.push_back(d);
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < scans.size(); ++j) {
      if (std::max(i, j) - std::min(i, j) < kOtherRound) continue;
      if (const double d = difference(scans[i], scans[j]); d < best) best = d;
    }
    other_round.push_back(best);
  }
  std::printf(
      "Median difference of the ranges of two scans: the next scan %.1f cm; the most similar scan a minute or "
      "more away %.1f cm (90 %% below %.1f cm).\n",
      100.0 * eval::quantile(next, 0.5), 100.0 * eval::quantile(other_round, 0.5),
      100.0 * eval::quantile(other_round, 0.9));
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
  sena();
  bigwheel(data);
  scitos(data);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
