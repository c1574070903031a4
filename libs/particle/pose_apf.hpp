#pragma once
/// Neighbour optimisation of poses in a Rao-Blackwellised filter, whose particles have maps and paths of their own.
#include <cstdint>
#include <span>
#include <vector>

#include "core/pose2.hpp"
#include "particle/apf.hpp"

namespace noctule::particle {

/// Which map and path a moved particle goes on with.
enum class MapOf : std::int8_t {
  own,  ///< its own, with a pose that fits the neighbour's map better: harms where maps differ, at loop closures most
  neighbour  ///< that of the neighbour it moved toward: map and pose were made together
};

/// What a slot of the new set holds.
struct PoseSlot {
  std::uint32_t ancestor;  ///< particle whose map and path it takes; equals the slot where it may stay in place
  Pose2 pose;
  bool moved;  ///< the pose is none of the old ones: what depends on it (map updates of this scan) comes after
};

/// Resampled poses of equal weight, of which some are moved (Apf). With MapOf::neighbour the ancestor of a moved
/// particle is the neighbour, whose own slot it never takes: copy maps and paths by `ancestor` from the old set, or in
/// place with slots that are their own ancestors left alone.
/// \param poses before resampling \param weights linear, before resampling
/// \param counts numbers of offspring, sum N; adapted
[[nodiscard]] std::vector<PoseSlot> apf_slots(Apf& apf, std::span<const Pose2> poses, std::span<const double> weights,
                                              std::span<std::uint32_t> counts, MapOf map_of, Rng& rng);

/// A better increment for a particle.
struct IncrementMove {
  std::uint32_t particle;
  Pose2 increment;
};

/// The move in the space of control increments, which mixes no maps: what the particles did in their latest step is
/// optimised, not where they are. To be called before resampling, with trial counts drawn from the weights. The filter
/// puts each moved particle at its own previous pose composed with the new increment, weighs it there (weight before
/// the measurement times likelihood with its own map; as with any importance weight that leaves the proposal out, the
/// set is biased toward where particles were moved), normalises, and resamples all as usual.
[[nodiscard]] std::vector<IncrementMove> apf_increments(Apf& apf, std::span<const Pose2> increments,
                                                        std::span<const double> weights,
                                                        std::span<const std::uint32_t> counts, Rng& rng);

/// Poses as states for Spread, Apf, regularise() and others.
[[nodiscard]] inline States pose_states(std::span<const Pose2> poses) {
  static_assert(sizeof(Pose2) == 3 * sizeof(double));
  return {poses.empty() ? nullptr : &poses[0].x, poses.size(), 3, 0b100};
}
[[nodiscard]] inline MutableStates pose_states(std::span<Pose2> poses) {
  return {poses.empty() ? nullptr : &poses[0].x, poses.size(), 3, 0b100};
}

}  // namespace noctule::particle
