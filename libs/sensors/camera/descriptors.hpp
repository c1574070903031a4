#pragma once
/// Binary descriptors of features and their comparison.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/pose2.hpp"

namespace noctule::sensors {

/// 256 bits of ORB (Rublee et al. 2011); two are as far apart as the number of bits in which they differ.
using Descriptor = std::array<std::uint64_t, 4>;

[[nodiscard]] int hamming(const Descriptor& a, const Descriptor& b);

/// Which of several descriptors, and how far away.
struct NearestDescriptor {
  std::size_t index = 0;
  int distance = 0;
};

/// The nearest of `known`, if it is at most `farthest` bits away and every descriptor outside its own group is farther
/// than its distance / ratio. On a tie the first.
/// \param groups of each of `known`: descriptors of one group show the same thing
[[nodiscard]] std::optional<NearestDescriptor> nearest_descriptor(const Descriptor& descriptor,
                                                                  std::span<const Descriptor> known,
                                                                  std::span<const int> groups, int farthest,
                                                                  double ratio);

}  // namespace noctule::sensors
