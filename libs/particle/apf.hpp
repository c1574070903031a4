#pragma once
/// Neighbour optimisation of a resampled set (APF, paper 002 section 1.1): some of the particles that resampling drops
/// take the places of duplicates, after a move toward a good neighbour.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/parameters.hpp"
#include "particle/kd_tree.hpp"
#include "particle/states.hpp"

namespace noctule::particle {

/// Which particles are "optimised" and toward which "fixed" ones.
enum class ApfSplit : std::int8_t {
  discarded,  ///< those without offspring, toward survivors: what helps
  lower_half  ///< the lighter half of the resampled set, toward the heavier one: what the paper's text says
};

struct ApfParameters {
  ApfSplit split = ApfSplit::discarded;
  double step = 3.0;  ///< (3): a move goes 1 - |n| / step of the way, n standard normal, within [0, 1]

  template <class Visitor>
  static void describe(Visitor& v) {
    v.choice("split", &ApfParameters::split, {{"discarded", ApfSplit::discarded}, {"lower_half", ApfSplit::lower_half}},
             "which particles are moved: those without offspring, or the lighter half of the resampled set");
    v.field("step", &ApfParameters::step, unit::one, "a move goes 1 - |n| / step of the way, n standard normal",
            positive());
  }
};

/// A particle in its new place.
struct MovedParticle {
  std::uint32_t slot;    ///< in the new set
  std::uint32_t from;    ///< the particle that moves: whose history it has
  std::uint32_t toward;  ///< the neighbour, a survivor
  double fraction;       ///< of the way, in [0, 1]
};

/// x_from + fraction (x_toward - x_from), angles the short way. \param[out] state may be that of from
void apply_move(const MovedParticle& move, States states, double* state);

/// Paper 002, eqs. 1 to 3. Distances are Mahalanobis' with the covariance of all particles, so that metres and radians
/// mix and no scale matters. With d = 2 dim + 1: from the optimised group the farthest particle from a reference (first
/// the best fixed one, then the particle moved last) moves toward the heaviest of its 2 dim nearest fixed particles; it
/// and its 2 dim nearest leave the group; until fewer than d are left.
///
/// All distinct survivors stay: moved particles replace copies, the most numerous first. With equal weights nothing
/// happens. O(N log N); memory is kept between calls.
///
/// Weights stay 1/N, so that up to 1/d of the optimised group comes back with more weight than the measurement gave it:
/// the set is wider than the posterior (in a linear model with a precise measurement by 2.8 times its variance), while
/// its mean stays. That acts as more process noise, which helps when particles are few or the filter believes in too
/// little of it, and is why nothing is gained with many. Estimates belong before it.
///
/// In a Rao-Blackwellised filter (`from` and `toward` have maps of their own) a moved particle either keeps the map and
/// path of `from`, or takes those of `toward`; see pose_apf.hpp.
class Apf {
 public:
  explicit Apf(const ApfParameters& parameters = {}) : parameters_(parameters) {}

  /// \param states before resampling; not overwritten
  /// \param weights N linear weights before resampling
  /// \param[in,out] counts N numbers of offspring, sum N, of any resampler of equal weights; adapted: sum N still
  /// \param[out] ancestors N: the particle whose copy, moved or not, each slot holds; survivors and discarded particles
  ///             that move are in their own slots, so that states can be copied and moved in place
  /// \return those that move, valid until the next call
  /// \throws std::invalid_argument when numbers do not fit
  std::span<const MovedParticle> optimise(States states, std::span<const double> weights,
                                          std::span<std::uint32_t> counts, std::span<std::uint32_t> ancestors,
                                          Rng& rng);

  /// The moves alone, toward survivors, without places: `slot` equals `from`. \param counts as above; not adapted
  std::span<const MovedParticle> find_moves(States states, std::span<const double> weights,
                                            std::span<const std::uint32_t> counts, Rng& rng);

 private:
  void split(std::span<const double> weights, std::span<const std::uint32_t> counts);
  double normal(Rng& rng);
  void move_scalars(States states, std::span<const double> weights, std::size_t most, Rng& rng);
  void move_vectors(States states, std::span<const double> weights, std::size_t most, Rng& rng);
  void add_move(std::uint32_t from, std::uint32_t toward, Rng& rng);

  /// Scalar states of a group in order, between two infinities on either side.
  struct Line {
    void arrange(const double* states, std::vector<std::uint32_t>& group);
    std::vector<double> values;
  };

  ApfParameters parameters_;
  double normal_ = 0.0;
  bool have_normal_ = false;
  std::vector<std::uint32_t> optimised_, fixed_;  ///< particles; a copy each with lower_half
  std::vector<MovedParticle> moves_;
  Line optimised_line_, fixed_line_;
  std::vector<double> optimised_points_, fixed_points_;
  std::vector<std::uint32_t> near_optimised_, near_fixed_;
  KdTree optimised_tree_, fixed_tree_;
};

}  // namespace noctule::particle
