#pragma once
/// Who descends from whom: the histories of particles, and how many of the first ones still have descendants.
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/state_archive.hpp"

namespace noctule::particle {

/// Histories of N particles as a tree: what descendants share is stored once, and branches without living descendants
/// are freed. An append costs O(1); resampling O(N) plus what it frees.
/// \tparam T one entry of a history
template <class T>
class Genealogy {
 public:
  explicit Genealogy(std::size_t particles)
      : leaves_(particles, kNone), founders_(particles), alive_(particles), distinct_founders_(particles) {
    for (std::size_t i = 0; i < particles; ++i) founders_[i] = static_cast<std::uint32_t>(i);
  }

  /// Adds an entry to the history of the particle in `slot`.
  void append(std::size_t slot, const T& value) {
    const std::uint32_t parent = leaves_[slot];
    if (unused_.empty()) {
      unused_.push_back(static_cast<std::uint32_t>(nodes_.size()));
      nodes_.emplace_back();
    }
    const std::uint32_t node = unused_.back();
    unused_.pop_back();
    nodes_[node] = {value, parent, 1};  // takes over the slot's reference to the parent
    leaves_[slot] = node;
  }

  /// The particle in slot i becomes a copy of the one that was in ancestors[i]. The number of particles may change.
  void resample(std::span<const std::uint32_t> ancestors) {
    new_leaves_.resize(ancestors.size());
    new_founders_.resize(ancestors.size());
    for (std::size_t i = 0; i < ancestors.size(); ++i) {
      new_leaves_[i] = leaves_[ancestors[i]];
      new_founders_[i] = founders_[ancestors[i]];
      if (new_leaves_[i] != kNone) ++nodes_[new_leaves_[i]].references;
    }
    for (const std::uint32_t leaf : leaves_) release(leaf);
    std::swap(leaves_, new_leaves_);
    std::swap(founders_, new_founders_);
    distinct_founders_ = count_founders();
  }

  /// Entries of the particle in `slot`, oldest first.
  [[nodiscard]] std::vector<T> history(std::size_t slot) const {
    std::vector<T> result;
    for (std::uint32_t node = leaves_[slot]; node != kNone; node = nodes_[node].parent) {
      result.push_back(nodes_[node].value);
    }
    std::ranges::reverse(result);
    return result;
  }

  /// \param value lists the members of an entry
  template <class Value>
  void transfer(StateArchive& archive, const Value& value) {
    archive.each(nodes_, Node{}, [&](Node& node) {
      value(node.value);
      archive(node.parent, node.references);
    });
    archive(unused_, leaves_, founders_, distinct_founders_);
  }

  /// How many of the first particles still have descendants.
  [[nodiscard]] std::size_t distinct_founders() const { return distinct_founders_; }

  /// Entries stored: at most N times the length, near the length alone once the histories have one trunk.
  [[nodiscard]] std::size_t stored() const { return nodes_.size() - unused_.size(); }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  struct Node {
    T value;
    std::uint32_t parent;
    std::uint32_t references;  ///< by children and by slots
  };

  void release(std::uint32_t node) {
    while (node != kNone && --nodes_[node].references == 0) {
      unused_.push_back(node);
      node = nodes_[node].parent;
    }
  }

  std::size_t count_founders() {
    std::ranges::fill(alive_, char{0});
    for (const std::uint32_t founder : founders_) alive_[founder] = 1;
    return static_cast<std::size_t>(std::ranges::count(alive_, char{1}));
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> unused_;
  std::vector<std::uint32_t> leaves_;    ///< last entry of each slot
  std::vector<std::uint32_t> founders_;  ///< first particle that each slot descends from
  std::vector<char> alive_;              ///< of each first particle, whether it has descendants
  std::size_t distinct_founders_;
  std::vector<std::uint32_t> new_leaves_, new_founders_;  ///< scratch, kept so that resampling allocates nothing
};

}  // namespace noctule::particle
