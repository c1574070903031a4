#include "eval/track_distance.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace noctule::eval {
namespace {

/// The part of a track within the window.
std::span<const TrackPoint> within(const Track& track, const Window& window) {
  if (window.last < window.first) throw std::invalid_argument("track distance: the window ends before it begins");
  const auto by_step = [](const TrackPoint& a, const TrackPoint& b) { return a.step < b.step; };
  if (std::ranges::adjacent_find(track, [&](const auto& a, const auto& b) { return !by_step(a, b); }) != track.end()) {
    throw std::invalid_argument("track distance: steps of a track must increase");
  }
  const auto begin = std::ranges::lower_bound(track, window.first, {}, &TrackPoint::step);
  const auto end = std::ranges::upper_bound(begin, track.end(), window.last, {}, &TrackPoint::step);
  return {begin, end};
}

double distance(std::span<const TrackPoint> a, std::span<const TrackPoint> b, const SetDistanceParameters& p) {
  double sum = 0.0;  // of (e / c)^p
  int steps = 0;
  for (auto i = a.begin(), j = b.begin(); i != a.end() || j != b.end(); ++steps) {
    if (j == b.end() || (i != a.end() && i->step < j->step)) {
      sum += 1.0;
      ++i;
    } else if (i == a.end() || j->step < i->step) {
      sum += 1.0;
      ++j;
    } else {
      sum += std::pow(std::min(1.0, (i->position - j->position).norm() / p.cutoff), p.order);
      ++i;
      ++j;
    }
  }
  return steps > 0 ? p.cutoff * std::pow(sum / steps, 1.0 / p.order) : 0.0;
}

std::vector<std::span<const TrackPoint>> alive(std::span<const Track> tracks, const Window& window) {
  std::vector<std::span<const TrackPoint>> parts;
  for (const Track& t : tracks) {
    const auto part = within(t, window);
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

}  // namespace

double track_distance(const Track& a, const Track& b, const Window& window, const SetDistanceParameters& p) {
  (void)ospa(Eigen::MatrixXd(0, 0), p);  // refuses bad parameters
  return distance(within(a, window), within(b, window), p);
}

Ospa ospa2(std::span<const Track> estimates, std::span<const Track> truth, const Window& window,
           const SetDistanceParameters& p) {
  const auto a = alive(estimates, window), b = alive(truth, window);
  Eigen::MatrixXd d(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) d(i, j) = distance(a[i], b[j], p);
  }
  return ospa(d, p);
}

}  // namespace noctule::eval
