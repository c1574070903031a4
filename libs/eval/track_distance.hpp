#pragma once
/// Distance between sets of tracks: also switched and broken identities count.
#include <cstdint>
#include <span>
#include <vector>

#include "eval/set_distance.hpp"

namespace noctule::eval {

/// Where an object was at a step of time; a track is a sequence of strictly increasing steps, gaps allowed.
struct TrackPoint {
  std::int64_t step = 0;
  Vector2 position = Vector2::Zero();  ///< [m]
};
using Track = std::vector<TrackPoint>;

/// Steps from `first` to `last`, both included.
struct Window {
  std::int64_t first = 0;
  std::int64_t last = 0;
};

/// Time-averaged distance of two tracks within the window: [mean of e^p]^(1/p) over the steps at which at least one of
/// them exists, e being min(c, distance) where both do, c where one does. 0 where neither ever does.
/// \throws std::invalid_argument as set distances do, and for a window that ends before it begins (both functions)
[[nodiscard]] double track_distance(const Track&, const Track&, const Window&, const SetDistanceParameters& = {});

/// OSPA(2) (Beard, Vo and Vo 2017; 2020): OSPA over the tracks that exist somewhere in the window, with
/// track_distance() as the distance of two of them. With p = 1 the original; for other orders the inner mean is of the
/// same order as the outer one, as in the authors' toolbox.
[[nodiscard]] Ospa ospa2(std::span<const Track> estimates, std::span<const Track> truth, const Window&,
                         const SetDistanceParameters& = {});

}  // namespace noctule::eval
