/// Mapping of the heptagon room: time and, as counters, what was found, what was invented and the mean errors over
/// walls 2 to 7 (cm, deg) and cylinders (cm).
/// - sonar: two loops of scans with the pinned noise and known poses, about 2200 echoes;
/// - points: the outline sampled every 2 cm with 5 mm noise and 10 % clutter, the same points for every method.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include "mapping/contour_mapper.hpp"
#include "mapping/hough.hpp"
#include "mapping/occupancy_grid.hpp"
#include "unit/mapping/heptagon.hpp"

#ifdef NOCTULE_WITH_OPENCV
#include <opencv2/imgproc.hpp>
#endif
#ifdef NOCTULE_WITH_MRPT
#include <mrpt/math/ransac_applications.h>
#endif

namespace noctule::mapping {
namespace {

constexpr double kSigma = 0.005;
constexpr double kClutter = 0.10;

void report(benchmark::State& state, const ContourMap& map) {
  const heptagon::Score s = heptagon::score(map);
  state.counters["walls"] = s.walls_found;
  state.counters["walls+"] = s.walls_invented;  // invented, or a second time
  state.counters["cylinders"] = s.cylinders_found;
  state.counters["cylinders+"] = s.cylinders_invented;
  state.counters["rho_cm"] = 100.0 * s.rho;
  state.counters["theta_deg"] = degrees(s.theta);
  state.counters["cylinder_cm"] = 100.0 * s.cylinder;
}

void sonar_batch(benchmark::State& state) {
  const auto scans = heptagon::drive({}, 1);
  ContourMap map;
  for (auto _ : state) map = map_contours(scans, {});
  report(state, map);
}
BENCHMARK(sonar_batch)->Unit(benchmark::kMillisecond);

void sonar_incremental(benchmark::State& state) {
  const auto scans = heptagon::drive({}, 1);
  ContourMap map;
  for (auto _ : state) {
    ContourMapper mapper{MapperParameters{}};
    for (const PosedScan& s : scans) mapper.add(s.scan, s.base_in_map);
    map = mapper.map();
  }
  report(state, map);
}
BENCHMARK(sonar_incremental)->Unit(benchmark::kMillisecond);

void sonar_incremental_map(benchmark::State& state) {
  ContourMapper mapper{MapperParameters{}};
  for (const PosedScan& s : heptagon::drive({}, 1)) mapper.add(s.scan, s.base_in_map);
  for (auto _ : state) benchmark::DoNotOptimize(mapper.map());
}
BENCHMARK(sonar_incremental_map)->Unit(benchmark::kMicrosecond);

void sonar_occupancy_grid(benchmark::State& state) {
  const auto scans = heptagon::drive({}, 1);
  for (auto _ : state) {
    OccupancyGrid grid{OccupancyParameters{}};
    for (const PosedScan& s : scans) grid.add(s.scan, s.base_in_map);
    benchmark::DoNotOptimize(grid.log_odds(0, 0));
  }
}
BENCHMARK(sonar_occupancy_grid)->Unit(benchmark::kMillisecond);

void points_lines_noctule(benchmark::State& state) {
  const auto points = heptagon::outline(kSigma, kClutter, 1);
  ContourMap map;
  for (auto _ : state) map.walls = hough_lines(points, {});
  report(state, map);
}
BENCHMARK(points_lines_noctule)->Unit(benchmark::kMillisecond);

void points_circles_noctule(benchmark::State& state) {
  const auto points = heptagon::outline(kSigma, kClutter, 1);
  ContourMap map;
  for (auto _ : state) map.cylinders = hough_circles(points, {});
  report(state, map);
}
BENCHMARK(points_circles_noctule)->Unit(benchmark::kMillisecond);

#ifdef NOCTULE_WITH_OPENCV
/// The accumulator of the same resolution and reach; OpenCV neither suppresses neighbours of a peak nor refines it, so
/// a wall is returned many times.
void points_lines_opencv(benchmark::State& state) {
  std::vector<cv::Point2f> points;
  for (const auto& p : heptagon::outline(kSigma, kClutter, 1)) {
    points.emplace_back(static_cast<float>(p.position.x()), static_cast<float>(p.position.y()));
  }
  ContourMap map;
  for (auto _ : state) {
    cv::Mat lines;
    cv::HoughLinesPointSet(points, lines, 50, 20, -4.0, 4.0, HoughParameters{}.rho_bin, 0.0, CV_PI,
                           HoughParameters{}.theta_bin);
    map.walls.clear();
    for (int i = 0; i < lines.rows; ++i) {
      const auto line = lines.at<cv::Vec3d>(i);
      map.walls.push_back({.wall = normalised({line[1], line[2]})});
    }
  }
  report(state, map);
}
BENCHMARK(points_lines_opencv)->Unit(benchmark::kMillisecond);

/// The points drawn at 5 mm a pixel.
void points_circles_opencv(benchmark::State& state) {
  constexpr double kPixel = 0.005, kLow = -0.8;
  cv::Mat image = cv::Mat::zeros(800, 800, CV_8U);
  for (const auto& p : heptagon::outline(kSigma, kClutter, 1)) {
    const cv::Point at(static_cast<int>((p.position.x() - kLow) / kPixel),
                       static_cast<int>((p.position.y() - kLow) / kPixel));
    if (at.x >= 0 && at.y >= 0 && at.x < image.cols && at.y < image.rows) cv::circle(image, at, 2, 255, -1);
  }
  ContourMap map;
  for (auto _ : state) {
    std::vector<cv::Vec3f> circles;
    cv::HoughCircles(image, circles, cv::HOUGH_GRADIENT, 1.0, 40.0, 100.0, 12.0, 10, 60);
    map.cylinders.clear();
    for (const cv::Vec3f& c : circles) {
      map.cylinders.push_back({.cylinder = {{kLow + kPixel * c[0], kLow + kPixel * c[1]}, kPixel * c[2]}});
    }
  }
  report(state, map);
}
BENCHMARK(points_circles_opencv)->Unit(benchmark::kMillisecond);
#endif

#ifdef NOCTULE_WITH_MRPT
/// MRPT's RANSAC tells of each line on std::cout.
class Silence {
 public:
  Silence() : buffer_(std::cout.rdbuf(nullptr)) {}
  ~Silence() { std::cout.rdbuf(buffer_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  std::streambuf* buffer_;
};

void points_lines_mrpt_ransac(benchmark::State& state) {
  const auto points = heptagon::outline(kSigma, kClutter, 1);
  mrpt::math::CVectorDouble x, y;
  x.resize(points.size());
  y.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    x[static_cast<int>(i)] = points[i].position.x();
    y[static_cast<int>(i)] = points[i].position.y();
  }
  ContourMap map;
  const Silence silence;
  for (auto _ : state) {
    std::vector<std::pair<std::size_t, mrpt::math::TLine2D>> lines;
    mrpt::math::ransac_detect_2D_lines(x, y, lines, 3.0 * kSigma, 20);
    map.walls.clear();
    for (const auto& [inliers, line] : lines) {
      const double norm = std::hypot(line.coefs[0], line.coefs[1]);
      map.walls.push_back({.wall = normalised({-line.coefs[2] / norm, std::atan2(line.coefs[1], line.coefs[0])})});
    }
  }
  report(state, map);
}
BENCHMARK(points_lines_mrpt_ransac)->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace noctule::mapping
