#pragma once
/// How many different particles a particle filter really has. Three measures, because resampling, moves and time each
/// take away another kind of variety.
#include <cstdint>
#include <span>
#include <vector>

#include "core/estimate.hpp"

namespace noctule::eval {

/// Ancestry after one step.
struct Diversity {
  int distinct_parents = 0;    ///< particles of the step before that have survived
  int distinct_ancestors = 0;  ///< particles `lag` steps back (or at the start, if that is later) that have descendants
  int distinct_founders = 0;   ///< first particles that have descendants: falls towards 1, never rises
};

/// \param parents for each step, the index of each particle's parent among the particles of the step before; without
///        resampling 0, 1, 2, ... The number of particles may change. \param lag steps, >= 1
/// \throws std::invalid_argument for lag < 1 or a parent that does not exist
[[nodiscard]] std::vector<Diversity> diversity(std::span<const std::vector<std::uint32_t>> parents, int first_particles,
                                               int lag);

/// Different poses among the particles: moves after resampling make new poses, but no new ancestors. Poses are equal
/// when all of x, y, yaw round to the same multiple of `resolution` [m, m, rad].
[[nodiscard]] int distinct_poses(std::span<const WeightedPose> particles, double resolution = 1e-9);

/// (sum w)^2 / sum w^2, in [1, N]; weights need not be normalised. NaN when they sum to 0 or are not finite.
[[nodiscard]] double effective_sample_size(std::span<const WeightedPose> particles);

}  // namespace noctule::eval
