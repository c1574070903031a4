#include "eval/box_overlap.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/limits.hpp"

namespace noctule::eval {

double success(std::span<const double> overlaps, double threshold) {
  if (overlaps.empty()) return kNan;
  const auto above = std::ranges::count_if(overlaps, [&](double v) { return v > threshold; });
  return static_cast<double>(above) / static_cast<double>(overlaps.size());
}

BoxTrackScores box_track_scores(std::span<const ImageBox> estimates, std::span<const ImageBox> truth) {
  if (estimates.size() != truth.size()) throw std::invalid_argument("box track: as many estimates as true boxes");
  BoxTrackScores s;
  std::vector<double> overlaps;
  double squares = 0.0, near = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    overlaps.push_back(overlap(estimates[i], truth[i]));
    s.overlap += overlaps.back();
    const double square = (estimates[i].centre - truth[i].centre).squaredNorm();
    squares += square;
    if (square <= 20.0 * 20.0) near += 1.0;
  }
  const auto n = static_cast<double>(truth.size());  // 0: every figure is 0 / 0
  s.frames = static_cast<int>(truth.size());
  s.overlap /= n;
  s.precision20 = near / n;
  s.centre_rmse = std::sqrt(squares / n);
  for (int i = 0; i <= 20; ++i) s.success_auc += success(overlaps, 0.05 * i) / 21.0;
  return s;
}

std::vector<Reacquisition> reacquisitions(std::span<const double> overlaps, std::span<const int> losses) {
  std::vector<Reacquisition> list;
  for (std::size_t i = 0; i < losses.size(); ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(losses[i]);
    const auto end = i + 1 < losses.size() ? static_cast<std::ptrdiff_t>(losses[i + 1]) : std::ssize(overlaps);
    if (begin < 0 || begin >= end || end > std::ssize(overlaps))
      throw std::invalid_argument("reacquisitions: losses must be ascending frames of the sequence");
    const auto window = overlaps.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
    const auto at = std::ranges::find_if(window, [](double v) { return v > 0.5; });
    list.push_back({static_cast<int>(at - window.begin()), at != window.end()});
  }
  return list;
}

}  // namespace noctule::eval
