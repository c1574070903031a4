#pragma once
/// Counter-based random numbers: nothing to seed or copy per particle, equal on every platform and thread count.
/// Philox4x32-10 (Salmon, Moraes, Dror, Shaw: "Parallel random numbers: as easy as 1, 2, 3", SC 2011).
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "core/angles.hpp"

namespace noctule {

[[nodiscard]] constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Identifier of a random stream from its name (FNV-1a), so that every sensor and every filter draws from its own:
/// `stream_id("sonar.noise")`.
[[nodiscard]] constexpr std::uint64_t stream_id(std::string_view name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : name) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  return hash;
}

/// Philox4x32-10 block function; public for its known-answer test.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                                                std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// A short sequence of random numbers addressed by (seed, stream, step, slot): the same address gives the same
/// numbers wherever and whenever it is asked. `step` is usually the scan or event number, `slot` the particle.
/// Each address holds 2^32 blocks of two numbers. Cheap to create; meant to live on the stack.
class Rng {
 public:
  using result_type = std::uint64_t;

  explicit Rng(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t step = 0, std::uint32_t slot = 0) {
    const std::uint64_t key = splitmix64(seed ^ splitmix64(stream));
    key_ = {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)};
    counter_ = {0, slot, static_cast<std::uint32_t>(step), static_cast<std::uint32_t>(step >> 32)};
  }

  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }

  /// 64 random bits (also makes this a UniformRandomBitGenerator).
  std::uint64_t operator()() {
    if (!have_word_) {
      const auto block = philox4x32(counter_, key_);
      ++counter_[0];
      word_ = (std::uint64_t{block[3]} << 32) | block[2];
      have_word_ = true;
      return (std::uint64_t{block[1]} << 32) | block[0];
    }
    have_word_ = false;
    return word_;
  }

  /// Uniform in (0, 1): never 0, never 1 (53 bits, centred).
  double uniform() { return (static_cast<double>((*this)() >> 11) + 0.5) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Standard normal (Box-Muller; both numbers of a pair are used).
  double normal() {
    if (have_normal_) {
      have_normal_ = false;
      return normal_;
    }
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    const double angle = kTwoPi * uniform();
    normal_ = radius * std::sin(angle);
    have_normal_ = true;
    return radius * std::cos(angle);
  }
  double normal(double mean, double sd) { return mean + sd * normal(); }

  /// Uniform integer in [0, n); 0 < n < 2^53.
  std::uint64_t index(std::uint64_t n) { return static_cast<std::uint64_t>(uniform() * static_cast<double>(n)); }

 private:
  std::array<std::uint32_t, 2> key_{};
  std::array<std::uint32_t, 4> counter_{};
  std::uint64_t word_ = 0;
  double normal_ = 0.0;
  bool have_word_ = false;
  bool have_normal_ = false;
};

}  // namespace noctule
