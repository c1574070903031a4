#include "particle/pose_apf.hpp"

namespace noctule::particle {

std::vector<PoseSlot> apf_slots(Apf& apf, std::span<const Pose2> poses, std::span<const double> weights,
                                std::span<std::uint32_t> counts, MapOf map_of, Rng& rng) {
  std::vector<std::uint32_t> ancestors(poses.size());
  const auto moves = apf.optimise(pose_states(poses), weights, counts, ancestors, rng);
  std::vector<PoseSlot> slots(poses.size());
  for (std::size_t i = 0; i < slots.size(); ++i) slots[i] = {ancestors[i], poses[ancestors[i]], false};
  for (const MovedParticle& move : moves) {
    PoseSlot& slot = slots[move.slot];
    apply_move(move, pose_states(poses), &slot.pose.x);
    slot.ancestor = map_of == MapOf::own ? move.from : move.toward;
    slot.moved = true;
  }
  return slots;
}

std::vector<IncrementMove> apf_increments(Apf& apf, std::span<const Pose2> increments, std::span<const double> weights,
                                          std::span<const std::uint32_t> counts, Rng& rng) {
  const States states = pose_states(increments);
  std::vector<IncrementMove> result;
  for (const MovedParticle& move : apf.find_moves(states, weights, counts, rng)) {
    result.push_back({move.from, {}});
    apply_move(move, states, &result.back().increment.x);
  }
  return result;
}

}  // namespace noctule::particle
