/// Estimates systematic and random errors of a recorded robot's odometry and sightings where its truth is known.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>

#include "apps/common/command_line.hpp"
#include "core/error.hpp"
#include "datasets/mrclam.hpp"
#include "eval/sensor_calibration.hpp"
#include "report/files.hpp"

namespace {

using namespace noctule;

std::string line(const std::string& key, double value, const std::string& comment) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%s: %.5g", key.c_str(), value);
  return std::string(text.data()) + (comment.empty() ? "" : "  # " + comment) + "\n";
}

std::string plus_minus(const eval::Estimated& e, double unit = 1.0) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "sd %.2g", e.sd / unit);
  return text.data();
}

std::string yaml(const eval::SensorCalibration& c, const std::string& from) {
  std::array<char, 240> text{};
  std::snprintf(
      text.data(), text.size(),
      "# Calibration by %s: %d windows of motion, %d sightings; %d outliers left out.\n"
      "# Correlation of the errors of range_scale and range_bias: %.2f; bearing bias %.2f deg (sd %.2g), not used.\n",
      from.c_str(), c.windows, c.sightings, c.outliers, c.range_correlation, degrees(c.bearing_bias.value),
      degrees(c.bearing_bias.sd));
  return text.data() + line("speed_scale", c.distance_scale.value, plus_minus(c.distance_scale)) +
         line("turn_scale", c.turn_scale.value, plus_minus(c.turn_scale)) +
         line("range_scale", c.range_scale.value, plus_minus(c.range_scale)) +
         line("range_bias_m", c.range_bias.value, plus_minus(c.range_bias)) + "odometry_noise:\n" +
         line("  along_m_per_sqrt_m", c.along, "") + line("  drift_deg_per_sqrt_m", degrees(c.drift), "") +
         line("  turn_deg_per_sqrt_rad", degrees(c.turn), "") + "range_noise:\n" +
         line("  base_cm", std::max(0.1, 100.0 * c.range_base), "") + line("  relative", c.range_relative, "") +
         line("bearing_sd_deg", degrees(c.bearing_sd), "");
}

/// "2,3,5"; empty: the robot of the file.
std::vector<int> parse_robots(const std::string& text, int robot) {
  if (text.empty()) return {robot};
  std::vector<int> robots;
  std::istringstream in(text);
  for (std::string number; std::getline(in, number, ',');) {
    const double value = apps::parse_option("--robots", number, 1.0);
    if (value > 5.0 || value != std::floor(value))
      throw InputError("--robots: expected numbers 1 to 5, got '" + text + "'");
    robots.push_back(static_cast<int>(value));
  }
  return robots;
}

std::string joined(const std::vector<int>& robots) {
  std::string text = robots.size() == 1 ? "robot " : "robots ";
  for (std::size_t i = 0; i < robots.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(robots[i]);
  return text;
}

int run(const apps::CommandLine& command, const std::string& out, const std::string& robots_text, double window) {
  const modules::PipelineParameters parameters = apps::load_pipeline(command);
  const auto* source = std::get_if<datasets::MrclamParameters>(&parameters.source);
  if (source == nullptr) {
    throw InputError(command.file + ": source.type: expected mrclam, the recording with true poses and landmarks");
  }
  datasets::MrclamParameters plain = *source;
  plain.speed_scale = plain.turn_scale = plain.range_scale = 1.0;
  plain.range_bias = 0.0;
  plain.known_ids = true;
  const std::vector<int> robots = parse_robots(robots_text, plain.robot);
  std::vector<std::vector<Observation>> runs;
  std::vector<KnownLandmark> landmarks;
  for (const int robot : robots) {
    plain.robot = robot;
    datasets::Mrclam recording(plain);
    runs.emplace_back();
    while (auto observation = recording.next()) runs.back().push_back(std::move(*observation));
    landmarks = recording.world().landmarks;
  }
  const eval::SensorCalibration c = eval::calibrate_sensors(runs, landmarks, {.window = window});
  for (const double value : {c.distance_scale.value, c.turn_scale.value, c.range_scale.value}) {
    if (!std::isfinite(value)) {
      throw InputError(plain.path.string() + ": expected true poses, motion and sightings of known landmarks, got " +
                       std::to_string(c.windows) + " windows and " + std::to_string(c.sightings) + " sightings");
    }
  }
  const std::string text = yaml(c, plain.path.filename().string() + ", " + joined(robots));
  if (out == "-") {
    std::cout << text;
  } else {
    report::write_file(out, text);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string out = "-", robots, window = "2";
  const apps::Program program{
      .name = "noctule-calibrate",
      .description =
          "Estimates scales, biases and noise of a recorded robot's odometry and sightings from its truth, "
          "as keys of a pipeline file's source (source: {file: CALIBRATION, ...}).",
      .options = {
          {"--out", &out, "file to write; -: the terminal"},
          {"--robots", &robots, "robots of the data set to estimate from together, 2,3,4 (default: the file's)"},
          {"--window", &window, "seconds of motion that make one equation"}}};
  const apps::CommandLine line = apps::parse_command_line(argc, argv, program);
  return apps::run_guarded(program.name,
                           [&] { return run(line, out, robots, apps::parse_option("--window", window, 0.1)); });
}
