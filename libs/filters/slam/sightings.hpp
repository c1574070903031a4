#pragma once
/// Point landmarks seen by range and bearing, conditioned on the path of one particle (FastSLAM 1: Montemerlo, Thrun,
/// Koller, Wegbreit, AAAI 2002).
#include <cstdint>
#include <vector>

#include "core/observations.hpp"
#include "filters/slam/contour_observation.hpp"
#include "filters/slam/parameters.hpp"
#include "filters/slam/point_landmark.hpp"

namespace noctule::filters {

/// Takes all sightings of one message into the map of a particle at `base`. Sightings with an identity go to the
/// landmark of that name or start it; the others are matched to the rest of the map, each landmark at most once, so
/// that the joint likelihood is largest. A sighting that finds no landmark pays the density of new ones, whether it
/// starts one or (when it lies between the gate and `new_above`) is dropped.
/// \param first_id identity of the landmark that the first sighting may start; the k-th gets first_id - k
[[nodiscard]] ObservationFit apply_sightings(const LandmarkDetections& sightings, const Pose2& base,
                                             std::int64_t first_id, const SightingParameters& parameters,
                                             std::vector<PointLandmark>& map);

}  // namespace noctule::filters
