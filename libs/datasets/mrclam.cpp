#include "datasets/mrclam.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "core/error.hpp"
#include "datasets/held_commands.hpp"
#include "datasets/table.hpp"

namespace noctule::datasets {
namespace {

using Path = std::filesystem::path;

std::optional<Path> find(const Path& folder, const std::string& name) {
  for (const Path& path : {folder / name, folder / (name + ".gz")}) {
    if (std::filesystem::exists(path)) return path;
  }
  return std::nullopt;
}

Path require(const Path& folder, const std::string& name) {
  if (auto path = find(folder, name)) return *path;
  if (!std::filesystem::is_directory(folder)) {
    throw InputError("path: expected the folder of an MR.CLAM data set, got '" + folder.string() + "'");
  }
  throw InputError(folder.string() + ": expected a file " + name + " or " + name + ".gz, got neither");
}

TableFormat dat(std::vector<std::string> columns) {
  return {.columns = std::move(columns), .comment = '#'};
}

void append(std::vector<std::string>& notes, const std::vector<std::string>& more) {
  notes.insert(notes.end(), more.begin(), more.end());
}

std::string counted(std::int64_t count, const std::string& what) {
  return std::to_string(count) + " " + what;
}

std::vector<Command> read_commands(const Path& path, const MrclamParameters& p, Recording& recording) {
  const Table table(path, dat({"time_s", "v_m_per_s", "w_rad_per_s"}));
  table.require_ascending(0, true);
  append(recording.notes, table.notes());
  std::vector<Command> commands;
  for (int row = 0; row < table.rows(); ++row) {
    commands.push_back({table.utime(row, 0, 1.0), p.speed_scale * table(row, 1), p.turn_scale * table(row, 2)});
  }
  return commands;
}

void read_landmarks(const Path& folder, const MrclamParameters& p, Recording& recording) {
  const Table table(require(folder, "Landmark_Groundtruth.dat"), dat({"subject", "x_m", "y_m", "x_sd_m", "y_sd_m"}));
  append(recording.notes, table.notes());
  std::vector<KnownLandmark>& landmarks = recording.world.landmarks;
  for (int row = 0; row < table.rows(); ++row) {
    landmarks.push_back({table.integer(row, 0), Vector2(table(row, 1), table(row, 2))});
  }
  if (!p.swap_11_17) return;
  const auto by_id = [&](std::int64_t id) {
    const auto found = std::find_if(landmarks.begin(), landmarks.end(), [&](const auto& l) { return l.id == id; });
    if (found == landmarks.end()) {
      throw InputError(folder.string() + ": swap_11_17: expected landmarks 11 and 17, got no " + std::to_string(id));
    }
    return found;
  };
  std::swap(by_id(11)->position, by_id(17)->position);
}

// Bar code -> subject.
std::map<std::int64_t, std::int64_t> read_barcodes(const Path& folder, Recording& recording) {
  const Table table(require(folder, "Barcodes.dat"), dat({"subject", "barcode"}));
  append(recording.notes, table.notes());
  std::map<std::int64_t, std::int64_t> subjects;
  for (int row = 0; row < table.rows(); ++row) {
    if (!subjects.emplace(table.integer(row, 1), table.integer(row, 0)).second) {
      table.refuse(row, 1, "each bar code once");
    }
  }
  return subjects;
}

LandmarkDetection detection(const MrclamParameters& p, std::int64_t subject, double measured, double bearing) {
  LandmarkDetection d;
  const double range = std::max(0.0, (measured - p.range_bias) / p.range_scale);
  d.range = range;
  d.bearing = wrap(bearing);
  const double range_sd = p.range_noise.sd(range);
  d.covariance << range_sd * range_sd, 0.0, 0.0, p.bearing_sd * p.bearing_sd;
  if (p.known_ids) d.id = subject;
  return d;
}

// Sightings of landmarks between two times, those of one time stamp together.
std::vector<LandmarkDetections> read_sightings(const Path& folder, const MrclamParameters& p, std::int64_t begin,
                                               std::int64_t end, Recording& recording) {
  const auto subjects = read_barcodes(folder, recording);
  const Path path = require(folder, "Robot" + std::to_string(p.robot) + "_Measurement.dat");
  const Table table(path, dat({"time_s", "barcode", "range_m", "bearing_rad"}));
  table.require_ascending(0, true);
  append(recording.notes, table.notes());

  std::vector<LandmarkDetections> frames;
  std::int64_t nobody = 0, robots = 0, outside = 0;
  for (int row = 0; row < table.rows(); ++row) {
    const std::int64_t utime = table.utime(row, 0, 1.0);
    const double range = table.at_least(0.0, row, 2);
    const auto subject = subjects.find(table.integer(row, 1));
    if (subject == subjects.end()) {
      ++nobody;
      continue;
    }
    const auto& landmarks = recording.world.landmarks;
    if (std::none_of(landmarks.begin(), landmarks.end(), [&](const auto& l) { return l.id == subject->second; })) {
      ++robots;
      continue;
    }
    if (utime < begin || utime > end) {
      ++outside;
      continue;
    }
    if (frames.empty() || frames.back().stamp.utime != utime) frames.push_back({{utime, 0}, {}, {}});
    frames.back().detections.push_back(detection(p, subject->second, range, table(row, 3)));
  }
  if (nobody + robots + outside > 0) {
    recording.notes.push_back(path.string() + ": left out " + counted(robots, "sightings of robots, ") +
                              counted(nobody, "of bar codes of nobody, ") +
                              counted(outside, "of landmarks outside the time of the odometry"));
  }
  return frames;
}

// Truth times in whole seconds were rounded: the rows of second s are spread evenly over [s - 0.5, s + 0.5).
std::vector<std::int64_t> spread(const Table& table) {
  std::vector<std::int64_t> utimes;
  for (int row = 0; row < table.rows();) {
    int next = row;
    while (next < table.rows() && table(next, 0) == table(row, 0)) ++next;
    if (std::trunc(table(row, 0)) != table(row, 0)) table.refuse(row, 0, "whole seconds (spread_seconds)");
    const std::int64_t second = table.utime(row, 0, 1.0), count = next - row;
    for (std::int64_t i = 0; i < count; ++i) utimes.push_back(second - 500'000 + (2 * i + 1) * 500'000 / count);
    row = next;
  }
  return utimes;
}

std::vector<GroundTruth> read_truth(const Path& folder, const MrclamParameters& p, Recording& recording) {
  const std::string stem = "Robot" + std::to_string(p.robot) + "_Groundtruth";
  TableFormat format = dat({"time_s", "x_m", "y_m", "heading_rad"});
  std::optional<Path> path = find(folder, stem + ".dat");
  if (!path) {
    path = find(folder, stem + ".csv");
    if (!path) path = find(folder, stem + "_int_seconds.csv");
    if (!path) {
      recording.notes.push_back(folder.string() + ": no " + stem + ".dat, .csv or .gz; there is no truth");
      return {};
    }
    format.separator = ',';
    format.header = "Time,X,Y,Orientation";
  }
  const Table table(*path, format);
  table.require_ascending(0, true);
  append(recording.notes, table.notes());
  std::vector<std::int64_t> utimes;
  if (p.spread_seconds) {
    utimes = spread(table);
  } else {
    for (int row = 0; row < table.rows(); ++row) utimes.push_back(table.utime(row, 0, 1.0));
  }
  std::vector<GroundTruth> truth;
  for (int row = 0; row < table.rows(); ++row) {
    if (!truth.empty() && truth.back().stamp.utime == utimes[static_cast<std::size_t>(row)]) continue;
    truth.push_back({{utimes[static_cast<std::size_t>(row)], 0}, {table(row, 1), table(row, 2), wrap(table(row, 3))}});
  }
  if (const std::int64_t repeated = table.rows() - std::ssize(truth); repeated > 0) {
    recording.notes.push_back(path->string() + ": left out " +
                              counted(repeated, "poses at the time of the one before"));
  }
  return truth;
}

// The true pose at a time, linear between rows, held outside.
Pose2 interpolated(const std::vector<GroundTruth>& truth, std::int64_t utime) {
  const auto after = std::find_if(truth.begin(), truth.end(), [&](const auto& t) { return t.stamp.utime >= utime; });
  if (after == truth.end()) return truth.back().base_in_map;
  if (after == truth.begin()) return after->base_in_map;
  const GroundTruth &a = *(after - 1), &b = *after;
  const double f = static_cast<double>(utime - a.stamp.utime) / static_cast<double>(b.stamp.utime - a.stamp.utime);
  const Vector3 d = f * difference(b.base_in_map, a.base_in_map);
  return {a.base_in_map.x + d.x(), a.base_in_map.y + d.y(), wrap(a.base_in_map.yaw + d.z())};
}

Recording read(const MrclamParameters& p) {
  const Path& folder = p.path;
  Recording recording;
  recording.world.name = "MR.CLAM, robot " + std::to_string(p.robot);
  const std::string robot = "Robot" + std::to_string(p.robot);
  const std::vector<Command> commands = read_commands(require(folder, robot + "_Odometry.dat"), p, recording);
  const std::int64_t begin = commands.front().utime, end = commands.back().utime;
  read_landmarks(folder, p, recording);
  const std::vector<LandmarkDetections> sightings = read_sightings(folder, p, begin, end, recording);
  const std::vector<GroundTruth> truth = read_truth(folder, p, recording);

  std::vector<std::int64_t> stops;
  for (const LandmarkDetections& s : sightings) stops.push_back(s.stamp.utime);
  for (const Odometry& o : integrate(commands, stops, p.odometry_noise)) recording.observations.emplace_back(o);
  recording.observations.insert(recording.observations.end(), sightings.begin(), sightings.end());
  for (const GroundTruth& t : truth) {
    if (t.stamp.utime >= begin && t.stamp.utime <= end) recording.observations.emplace_back(t);
  }
  if (!truth.empty()) recording.world.start_in_map = interpolated(truth, begin);
  return recording;
}

}  // namespace

Mrclam::Mrclam(const MrclamParameters& parameters) : RecordedSource(read(parameters)) {}

}  // namespace noctule::datasets
