#include "particle/apf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/angles.hpp"
#include "particle/resampling.hpp"

namespace noctule::particle {

void apply_move(const MovedParticle& move, States states, double* state) {
  const double* const from = states[move.from];
  const double* const toward = states[move.toward];
  for (int k = 0; k < states.dimension; ++k) {
    const double way = toward[k] - from[k];
    state[k] = states.is_angle(k) ? wrap(from[k] + move.fraction * wrap(way)) : from[k] + move.fraction * way;
  }
}

std::span<const MovedParticle> Apf::find_moves(States states, std::span<const double> weights,
                                               std::span<const std::uint32_t> counts, Rng& rng) {
  if (weights.size() != states.size || counts.size() != states.size) {
    throw std::invalid_argument("apf: one weight and one count per state are needed");
  }
  moves_.clear();
  have_normal_ = false;
  split(weights, counts);
  const auto group = static_cast<std::size_t>(2 * states.dimension + 1);
  // As many as there are copies to replace (a lower half may be larger than that).
  std::size_t copies = 0;
  for (const std::uint32_t n : counts) copies += n > 1 ? n - 1 : 0;
  const std::size_t most = std::min(optimised_.size() / group, copies);
  if (most == 0 || fixed_.empty()) return moves_;
  if (states.dimension == 1 && states.angles == 0) {
    move_scalars(states, weights, most, rng);
  } else {
    move_vectors(states, weights, most, rng);
  }
  return moves_;
}

void Apf::split(std::span<const double> weights, std::span<const std::uint32_t> counts) {
  const auto n = static_cast<std::uint32_t>(counts.size());
  if (parameters_.split == ApfSplit::discarded) {
    optimised_.resize(n + 1);
    fixed_.resize(n + 1);
    std::size_t dead = 0, alive = 0;
    for (std::uint32_t i = 0; i < n; ++i) {  // who survives cannot be predicted: no branch
      optimised_[dead] = fixed_[alive] = i;
      dead += counts[i] == 0;
      alive += counts[i] != 0;
    }
    optimised_.resize(dead);
    fixed_.resize(alive);
    return;
  }
  optimised_.clear();
  for (std::uint32_t i = 0; i < n; ++i) optimised_.insert(optimised_.end(), counts[i], i);
  std::ranges::stable_sort(optimised_, [&](std::uint32_t a, std::uint32_t b) { return weights[a] < weights[b]; });
  const auto middle = optimised_.begin() + static_cast<std::ptrdiff_t>(optimised_.size() / 2);
  fixed_.assign(middle, optimised_.end());
  optimised_.erase(middle, optimised_.end());
}

/// A standard normal number by Marsaglia's polar method; both of a pair are used.
double Apf::normal(Rng& rng) {
  if (std::exchange(have_normal_, false)) return normal_;
  double a, b, squared;
  do {
    a = rng.uniform(-1.0, 1.0);
    b = rng.uniform(-1.0, 1.0);
    squared = a * a + b * b;
  } while (squared >= 1.0 || squared == 0.0);
  const double scale = std::sqrt(-2.0 * std::log(squared) / squared);
  normal_ = b * scale;
  have_normal_ = true;
  return a * scale;
}

void Apf::add_move(std::uint32_t from, std::uint32_t toward, Rng& rng) {
  const double fraction = std::clamp(1.0 - std::abs(normal(rng)) / parameters_.step, 0.0, 1.0);
  moves_.push_back({from, from, toward, fraction});
}

/// Puts a group in order of its scalar states. Few are ranked by counting, which takes no branch: a comparison sort
/// guesses wrong half of the time.
void Apf::Line::arrange(const double* states, std::vector<std::uint32_t>& group) {
  constexpr std::size_t kFew = 128;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::size_t n = group.size();
  double least = kInfinity, most = -kInfinity;
  for (const std::uint32_t i : group) {
    least = std::min(least, states[i]);
    most = std::max(most, states[i]);
  }
  if (n > kFew || !(most > least)) {
    std::ranges::sort(group, {}, [&](std::uint32_t i) { return std::pair(states[i], i); });
  } else {
    // 24 bits of the state, 7 of the place in the group: what differs by less than a part in 2^24 is equal.
    std::array<std::int32_t, kFew> keys;
    std::array<std::uint32_t, kFew> sorted;
    const double scale = 16777215.0 / (most - least);
    for (std::size_t i = 0; i < n; ++i) {
      keys[i] = static_cast<std::int32_t>((states[group[i]] - least) * scale) * 128 + static_cast<std::int32_t>(i);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const std::int32_t key = keys[i];
      std::int32_t rank = 0;
      for (std::size_t j = 0; j < n; ++j) rank += keys[j] < key;
      sorted[static_cast<std::size_t>(rank)] = group[i];
    }
    std::copy_n(sorted.begin(), n, group.begin());
  }
  values.resize(n + 4);
  values[0] = values[1] = -kInfinity;
  for (std::size_t i = 0; i < n; ++i) values[i + 2] = states[group[i]];
  values[n + 2] = values[n + 3] = kInfinity;
}

/// On a line the farthest is at one of the ends, and its neighbours are next to it.
void Apf::move_scalars(States states, std::span<const double> weights, std::size_t most, Rng& rng) {
  optimised_line_.arrange(states.values, optimised_);
  fixed_line_.arrange(states.values, fixed_);
  double reference = states.values[*std::ranges::max_element(fixed_, {}, [&](std::uint32_t i) { return weights[i]; })];
  const double* const fixed = fixed_line_.values.data() + 2;  // two infinities before and behind
  const double* const ends = optimised_line_.values.data() + 2;
  // What is left of the group, and where its ends would stand among the fixed ones.
  std::size_t low = 0, high = optimised_.size() - 1, low_place = 0, high_place = fixed_.size();
  while (moves_.size() < most) {
    const bool lower = reference - ends[low] >= ends[high] - reference;
    const std::size_t end = lower ? low : high;
    const double x = ends[end];
    if (lower) {
      low += 3;
      while (fixed[low_place] < x) ++low_place;
    } else {
      high -= 3;
      while (fixed[static_cast<std::ptrdiff_t>(high_place) - 1] > x) --high_place;
    }
    // The two nearest fixed ones are neighbours: one on each side, or both on the one that is nearer.
    const double* const at = fixed + (lower ? low_place : high_place);
    const std::ptrdiff_t shift = (at[1] - x < x - at[-1]) - (x - at[-2] <= at[0] - x);
    const auto first = static_cast<std::size_t>(std::max<std::ptrdiff_t>(at - fixed - 1 + shift, 0));
    const std::uint32_t a = fixed_[first], b = fixed_[std::min(first + 1, fixed_.size() - 1)];
    add_move(optimised_[end], weights[b] > weights[a] ? b : a, rng);
    reference = x + moves_.back().fraction * (states.values[moves_.back().toward] - x);
  }
}

void Apf::move_vectors(States states, std::span<const double> weights, std::size_t most, Rng& rng) {
  const Spread spread(states);
  if (spread.is_point()) return;
  const auto dimension = static_cast<std::size_t>(states.dimension);
  const auto plant = [&](const std::vector<std::uint32_t>& group, std::vector<double>& points, KdTree& tree) {
    points.resize(group.size() * dimension);
    for (std::size_t i = 0; i < group.size(); ++i) spread.whiten(states[group[i]], points.data() + i * dimension);
    tree.build(points, states.dimension);
  };
  plant(optimised_, optimised_points_, optimised_tree_);
  plant(fixed_, fixed_points_, fixed_tree_);
  const auto best = static_cast<std::size_t>(
      std::ranges::max_element(fixed_, [&](std::uint32_t a, std::uint32_t b) { return weights[a] < weights[b]; }) -
      fixed_.begin());
  std::array<double, kMaxDimension> reference{}, state{};
  std::copy_n(fixed_points_.data() + best * dimension, dimension, reference.data());
  while (moves_.size() < most) {
    const std::uint32_t s = optimised_tree_.farthest(reference.data());
    const double* const x = optimised_points_.data() + s * dimension;
    fixed_tree_.nearest(x, 2 * dimension, near_fixed_);
    std::uint32_t toward = fixed_[near_fixed_.front()];
    for (const std::uint32_t near : near_fixed_) {
      if (weights[fixed_[near]] > weights[toward]) toward = fixed_[near];
    }
    add_move(optimised_[s], toward, rng);
    optimised_tree_.remove(s);
    optimised_tree_.nearest(x, 2 * dimension, near_optimised_);
    for (const std::uint32_t near : near_optimised_) optimised_tree_.remove(near);
    apply_move(moves_.back(), states, state.data());
    spread.whiten(state.data(), reference.data());
  }
}

std::span<const MovedParticle> Apf::optimise(States states, std::span<const double> weights,
                                             std::span<std::uint32_t> counts, std::span<std::uint32_t> ancestors,
                                             Rng& rng) {
  if (ancestors.size() != counts.size() ||
      std::accumulate(counts.begin(), counts.end(), std::size_t{0}) != counts.size()) {
    throw std::invalid_argument("apf: as many offspring as particles are needed");
  }
  find_moves(states, weights, counts, rng);
  remove_duplicates(static_cast<std::uint32_t>(moves_.size()), counts);
  for (const MovedParticle& move : moves_) ++counts[move.from];
  place_in_slots(counts, ancestors);
  if (parameters_.split == ApfSplit::lower_half) {  // a survivor's own slot is not for its moved copy
    for (std::size_t slot = 0, found = 0; slot < ancestors.size() && found < moves_.size(); ++slot) {
      if (ancestors[slot] == slot) continue;
      for (MovedParticle& move : moves_) {
        if (move.slot != move.from || move.from != ancestors[slot]) continue;
        move.slot = static_cast<std::uint32_t>(slot);
        ++found;
        break;
      }
    }
  }
  return moves_;
}

}  // namespace noctule::particle
