#pragma once
/// Which echoes to keep when not all can be.
#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mapping/sonar_arc.hpp"

namespace noctule::mapping {

/// Gives each arc a slot of a fixed number. Once all are taken, a random arc of the most crowded cell gives way: cells
/// are squares of the surface seen, by the direction it was seen from, so a wall passed once is not forgotten while
/// the robot keeps staring at another. Deterministic.
class ArcStore {
 public:
  /// \param capacity at least 1
  explicit ArcStore(int capacity) : capacity_(capacity) {}

  /// The slot for a new arc: the next free one, or that of the arc that gives way.
  [[nodiscard]] int place(const SonarArc& arc);

 private:
  using Cell = std::uint64_t;
  [[nodiscard]] static Cell cell_of(const SonarArc& arc);
  void enter(Cell cell, int slot);
  [[nodiscard]] int evict();

  int capacity_;
  int size_ = 0;
  std::uint64_t evictions_ = 0;
  std::unordered_map<Cell, std::vector<int>> slots_;
  std::set<std::pair<std::size_t, Cell>> by_size_;
};

}  // namespace noctule::mapping
