#include "mapping/arc_store.hpp"

#include <cmath>

#include "core/angles.hpp"
#include "core/rng.hpp"

namespace noctule::mapping {
namespace {
constexpr double kTile = 0.25;  // [m]
constexpr int kSectors = 8;
}  // namespace

ArcStore::Cell ArcStore::cell_of(const SonarArc& arc) {
  const Vector2 surface = (arc.sensor + arc.range * arc.axis) / kTile;
  const double turn = std::atan2(arc.axis.y(), arc.axis.x()) / kTwoPi + 0.5;
  const auto part = [](double v) { return static_cast<Cell>(static_cast<std::int64_t>(std::floor(v))) & 0xfffffff; };
  return (part(surface.x()) << 32) | (part(surface.y()) << 4) | (part(turn * kSectors) % kSectors);
}

void ArcStore::enter(Cell cell, int slot) {
  std::vector<int>& slots = slots_[cell];
  by_size_.erase({slots.size(), cell});
  slots.push_back(slot);
  by_size_.emplace(slots.size(), cell);
}

int ArcStore::evict() {
  const Cell cell = by_size_.rbegin()->second;
  std::vector<int>& slots = slots_[cell];
  by_size_.erase({slots.size(), cell});
  std::swap(slots[splitmix64(evictions_++) % slots.size()], slots.back());
  const int slot = slots.back();
  slots.pop_back();
  if (slots.empty()) {
    slots_.erase(cell);
  } else {
    by_size_.emplace(slots.size(), cell);
  }
  return slot;
}

int ArcStore::place(const SonarArc& arc) {
  const int slot = size_ < capacity_ ? size_++ : evict();
  enter(cell_of(arc), slot);
  return slot;
}

}  // namespace noctule::mapping
