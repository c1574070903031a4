#include "sim/landmark_map.hpp"

#include <cerrno>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/error.hpp"
#include "core/rng.hpp"

namespace noctule::sim {
namespace {

/// The lines of a map file that say something, with their numbers.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : path_(file.string()) {
    std::error_code error;
    const bool directory = std::filesystem::is_directory(file, error);
    errno = 0;
    stream_.open(file);
    if (stream_ && !directory) return;
    throw InputError(path_ + ": expected a readable map file, got: " +
                     (directory ? "a folder" : std::generic_category().message(errno)));
  }
  /// The next line in words; false at the end.
  [[nodiscard]] bool next(std::vector<std::string>& words) {
    for (std::string line; std::getline(stream_, line);) {
      ++number_;
      std::istringstream text(line.substr(0, line.find('#')));
      words.clear();
      for (std::string word; text >> word;) words.push_back(word);
      if (!words.empty()) return true;
    }
    return false;
  }
  [[noreturn]] void refuse(const std::string& expected, const std::string& got) const {
    throw InputError(path_ + ":" + std::to_string(number_) + ": expected " + expected + ", got " + got);
  }

 private:
  std::string path_;
  std::ifstream stream_;
  int number_ = 0;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text = "'";
  for (const std::string& word : words) text += (text.size() > 1 ? " " : "") + word;
  return text + "'";
}

/// Whether the whole word is a finite number.
bool read_number(const std::string& word, double& value) {
  char* end = nullptr;
  value = std::strtod(word.c_str(), &end);
  return end == word.c_str() + word.size() && std::isfinite(value);
}

}  // namespace

std::vector<Vector2> read_places(const std::filesystem::path& file, const std::string& block) {
  Lines lines(file);
  std::vector<std::string> words;
  const std::string heading = "a line '" + block + " 2 ROWS'";
  for (;;) {
    if (!lines.next(words)) lines.refuse(heading, "the end of the file");
    if (words[0] == block) break;
  }
  double columns = 0.0, rows = 0.0;
  const bool sound = words.size() == 3 && read_number(words[1], columns) && read_number(words[2], rows) &&
                     columns == 2.0 && rows >= 1.0 && rows <= 1e6 && rows == std::floor(rows);
  if (!sound) lines.refuse(heading, joined(words));
  std::vector<Vector2> places(static_cast<std::size_t>(rows));
  for (Vector2& place : places) {
    const std::string expected = std::to_string(places.size()) + " rows 'x y' of the block " + block;
    if (!lines.next(words)) lines.refuse(expected, "the end of the file");
    if (words.size() != 2 || !read_number(words[0], place.x()) || !read_number(words[1], place.y())) {
      lines.refuse(expected, joined(words));
    }
  }
  return places;
}

LandmarkMapPlaces places_of(const LandmarkMapParameters& p) {
  if (!p.waypoint_file.empty() && !p.waypoints.empty()) {
    throw InputError("world.waypoints_m: expected none beside a waypoint_file, got " +
                     std::to_string(p.waypoints.size()));
  }
  std::vector<Vector2> landmarks = p.landmarks;
  if (!p.landmark_file.empty()) {
    for (const Vector2& place : read_places(p.landmark_file, "lm")) landmarks.push_back(place);
  }
  if (p.scatter) {
    for (int i = 0; i < p.scatter->count; ++i) {
      Rng rng(p.scatter->seed, stream_id("sim.scatter"), static_cast<std::uint64_t>(i));
      const double x = rng.uniform(p.scatter->low.x(), p.scatter->high.x());
      landmarks.emplace_back(x, rng.uniform(p.scatter->low.y(), p.scatter->high.y()));
    }
  }
  if (landmarks.empty()) throw InputError("world: expected landmarks_m, landmark_file or scatter, got no landmark");

  LandmarkMapPlaces places{{p.scale * p.start.x, p.scale * p.start.y, p.start.yaw},
                           p.waypoint_file.empty() ? p.waypoints : read_places(p.waypoint_file, "wp"),
                           {}};
  if (places.waypoints.empty()) throw InputError("world: expected waypoints_m or waypoint_file, got no way-point");
  for (Vector2& place : places.waypoints) place *= p.scale;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    places.landmarks.push_back({static_cast<std::int64_t>(i), p.scale * landmarks[i]});
  }
  return places;
}

}  // namespace noctule::sim
