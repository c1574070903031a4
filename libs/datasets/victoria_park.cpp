#include "datasets/victoria_park.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/error.hpp"
#include "datasets/held_commands.hpp"
#include "datasets/mat_file.hpp"
#include "datasets/table.hpp"
#include "models/motion.hpp"

namespace noctule::datasets {
namespace {

namespace fs = std::filesystem;

constexpr double kNoReturnAbove = 80.0;  // [m] the scanner reports 81.91
constexpr std::size_t kBeams = 361;      // every half degree, from the right to the left
constexpr std::size_t kSlots = 18;       // of extracted trees
constexpr double kStartFit = 60.0;       // [s] of motion that fix the start
constexpr double kStandstill = 1.0;      // [m] driven until which the vehicle has not set out

/// Arrays of one length from a MATLAB file, times in microseconds.
class Columns {
 public:
  Columns(const fs::path& file, const std::string& time, const std::string& a, const std::string& b) {
    const auto arrays = read_mat(file);
    const auto column = [&](const std::string& name) -> const std::vector<double>& {
      const auto found = arrays.find(name);
      if (found == arrays.end()) throw InputError(file.string() + ": expected an array " + name + ", got none");
      return found->second;
    };
    a_ = column(a);
    b_ = column(b);
    const std::vector<double>& milliseconds = column(time);
    if (milliseconds.empty() || a_.size() != milliseconds.size() || b_.size() != milliseconds.size()) {
      throw InputError(file.string() + ": expected " + time + ", " + a + " and " + b + " of one length, got " +
                       std::to_string(milliseconds.size()) + ", " + std::to_string(a_.size()) + " and " +
                       std::to_string(b_.size()));
    }
    for (const double t : milliseconds) {
      if (!(std::abs(t) < 1e12)) throw InputError(file.string() + ": " + time + ": expected milliseconds");
      utimes_.push_back(std::llround(1e3 * t));
      if (utimes_.size() > 1 && utimes_.back() <= utimes_[utimes_.size() - 2]) {
        throw InputError(file.string() + ": " + time + ": expected rising times, got " + std::to_string(t) +
                         " in row " + std::to_string(utimes_.size()));
      }
    }
  }
  [[nodiscard]] std::size_t size() const { return utimes_.size(); }
  [[nodiscard]] std::int64_t utime(std::size_t i) const { return utimes_[i]; }
  [[nodiscard]] double a(std::size_t i) const { return a_[i]; }
  [[nodiscard]] double b(std::size_t i) const { return b_[i]; }

 private:
  std::vector<std::int64_t> utimes_;
  std::vector<double> a_, b_;
};

/// The first that exists. \throws InputError naming all
fs::path first_of(const fs::path& folder, const std::vector<fs::path>& names) {
  std::string all;
  for (const fs::path& name : names) {
    const fs::path path = folder / name;
    const fs::path archive = path.parent_path();
    if (fs::exists(path) || (archive.extension() == ".zip" && fs::exists(archive))) return path;
    all += (all.empty() ? "" : " or ") + name.string();
  }
  if (!fs::is_directory(folder)) {
    throw InputError("path: expected the folder of the Victoria Park recording, got '" + folder.string() + "'");
  }
  throw InputError(folder.string() + ": expected a file " + all + ", got none");
}

fs::path require_text(const fs::path& folder, const std::string& name) {
  return first_of(folder, {name, name + ".gz"});
}

std::vector<Command> read_commands(const VictoriaParkParameters& p) {
  const Columns rows(first_of(p.path, {"aa3_dr.mat"}), "time", "speed", "steering");
  std::vector<Command> commands;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto motion = models::rear_axle_motion(rows.a(i), rows.b(i), p.wheelbase, p.encoder_left);
    commands.push_back({rows.utime(i), motion.speed, motion.turn_rate});
  }
  return commands;
}

using Scans = std::vector<LandmarkDetections>;

/// \param first_fix when the clock of these files began
Scans read_laser(const VictoriaParkParameters& p, std::int64_t first_fix, Recording& recording) {
  TableFormat format{.columns = {"t_s"}, .unbroken = true};
  for (std::size_t i = 1; i <= kBeams; ++i) format.columns.push_back("r" + std::to_string(i) + "_m");
  const Table table(first_of(p.path, {"LASER.txt", "LASER.txt.gz", "victoria_park_ascii.zip/LASER.txt"}), format);
  table.require_ascending(0, false);
  recording.notes.insert(recording.notes.end(), table.notes().begin(), table.notes().end());
  Scans scans;
  std::vector<double> ranges(kBeams);
  for (int row = 0; row < table.rows(); ++row) {
    for (std::size_t i = 0; i < kBeams; ++i) ranges[i] = table.at_least(0.0, row, static_cast<int>(i) + 1);
    scans.push_back({{first_fix + table.utime(row, 0, 1.0), 0},
                     p.laser_in_base,
                     models::find_trunks({-0.5 * kPi, radians(0.5), kNoReturnAbove, ranges}, p.trunks)});
  }
  return scans;
}

Scans read_extracted(const VictoriaParkParameters& p, Recording& recording) {
  const auto slots = [&](const std::string& name, const std::string& unit) {
    TableFormat format;
    for (std::size_t i = 1; i <= kSlots; ++i) format.columns.push_back("tree" + std::to_string(i) + unit);
    return Table(require_text(p.path, name), format);
  };
  const Table times(require_text(p.path, "lasersampling.txt"), {.columns = {"t_ms"}});
  const Table ranges = slots("ObservationDistance.txt", "_m"), bearings = slots("ObservationAngle.txt", "_rad");
  times.require_ascending(0, false);
  for (const Table* t : {&times, &ranges, &bearings}) {
    recording.notes.insert(recording.notes.end(), t->notes().begin(), t->notes().end());
    if (t->rows() != times.rows()) {
      throw InputError(p.path.string() + ": expected as many rows in lasersampling.txt, ObservationDistance.txt and " +
                       "ObservationAngle.txt, got " + std::to_string(times.rows()) + ", " +
                       std::to_string(ranges.rows()) + " and " + std::to_string(bearings.rows()));
    }
  }
  Scans scans;
  for (int row = 0; row < times.rows(); ++row) {
    LandmarkDetections scan{{times.utime(row, 0, 1e-3), 0}, p.laser_in_base, {}};
    for (int i = 0; i < static_cast<int>(kSlots); ++i) {
      LandmarkDetection tree;
      tree.range = ranges.at_least(0.0, row, i);
      if (tree.range == 0.0 || tree.range > p.trunks.max_range) continue;
      tree.bearing = wrap(bearings(row, i) - 0.5 * kPi);  // counted from the right
      const double sd = p.extracted_range_noise.sd(tree.range);
      tree.covariance << sd * sd, 0.0, 0.0, p.extracted_bearing_sd * p.extracted_bearing_sd;
      scan.detections.push_back(tree);
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

/// Fixes within the time of the odometry, with dead reckoning from the origin at the first command.
std::vector<FixAndOdometry> with_odometry(const Columns& fixes, std::span<const Command> commands) {
  std::vector<FixAndOdometry> all;
  Pose2 pose;
  double way = 0.0;
  std::size_t now = 0;
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const std::int64_t utime = fixes.utime(i);
    if (utime < commands.front().utime || utime > commands.back().utime) continue;
    for (; now + 1 < commands.size() && commands[now + 1].utime <= utime; ++now) {
      const double dt = seconds(commands[now + 1].utime - commands[now].utime);
      pose = pose * held(commands[now], dt);
      way += std::abs(commands[now].speed) * dt;
    }
    const double rest = seconds(utime - commands[now].utime);
    all.push_back({{utime, {fixes.a(i), fixes.b(i)}},
                   (pose * held(commands[now], rest)).position(),
                   way + std::abs(commands[now].speed) * rest});
  }
  return all;
}

/// The start that brings dead reckoning to the fixes, least squares; the identity where they do not say.
Pose2 fitted_start(std::span<const FixAndOdometry> believed) {
  const auto moving = std::find_if(believed.begin(), believed.end(), [](const auto& f) { return f.way > kStandstill; });
  if (moving == believed.end()) return {};
  const std::int64_t last = moving->fix.utime + static_cast<std::int64_t>(1e6 * kStartFit);
  Vector2 from = Vector2::Zero(), to = Vector2::Zero();
  const auto end = std::find_if(moving, believed.end(), [&](const auto& f) { return f.fix.utime > last; });
  const std::span<const FixAndOdometry> used(moving, end);
  for (const auto& f : used) {
    from += f.dead_reckoned / static_cast<double>(used.size());
    to += f.fix.position / static_cast<double>(used.size());
  }
  double dot = 0.0, cross = 0.0;
  for (const auto& f : used) {
    const Vector2 a = f.dead_reckoned - from, b = f.fix.position - to;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
  }
  if (dot == 0.0 && cross == 0.0) return {};
  const Pose2 turn{0.0, 0.0, std::atan2(cross, dot)};
  const Vector2 origin = to - turn * from;
  return {origin.x(), origin.y(), turn.yaw};
}

Recording read(const VictoriaParkParameters& p) {
  Recording recording;
  recording.world.name = "Victoria Park";
  recording.world.start_is_rough = true;
  const std::vector<Command> commands = read_commands(p);
  const Columns fixes(first_of(p.path, {"aa3_gpsx.mat"}), "timeGps", "Lo_m", "La_m");
  Scans scans = p.trees == Trees::laser ? read_laser(p, fixes.utime(0), recording) : read_extracted(p, recording);
  std::erase_if(scans, [&](const LandmarkDetections& s) {
    return s.detections.empty() || s.stamp.utime < commands.front().utime || s.stamp.utime > commands.back().utime;
  });

  std::vector<std::int64_t> stops;
  for (const LandmarkDetections& s : scans) stops.push_back(s.stamp.utime);
  for (const Odometry& o : integrate(commands, stops, p.odometry_noise)) recording.observations.emplace_back(o);
  for (LandmarkDetections& s : scans) recording.observations.emplace_back(std::move(s));

  const std::vector<FixAndOdometry> all = with_odometry(fixes, commands);
  std::vector<FixAndOdometry> believed;
  for (const std::size_t i : believed_fixes(all, p.fixes)) believed.push_back(all[i]);
  for (const FixAndOdometry& f : believed) recording.world.fixes.push_back(f.fix);
  recording.world.start_in_map = fitted_start(believed);
  recording.notes.push_back(p.path.string() + ": believed " + std::to_string(believed.size()) + " of " +
                            std::to_string(fixes.size()) + " GPS fixes");
  return recording;
}

}  // namespace

VictoriaPark::VictoriaPark(const VictoriaParkParameters& parameters) : RecordedSource(read(parameters)) {}

}  // namespace noctule::datasets
