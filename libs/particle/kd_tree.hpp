#pragma once
/// Neighbours among points that are taken away one by one.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace noctule::particle {

/// Nearest and farthest points in any small dimension. Few points are one leaf: looking at all of them is faster then.
/// Boxes follow the points that are left, so that queries stay O(log N) for spread points. Memory is kept between
/// builds.
class KdTree {
 public:
  static constexpr std::size_t kMostNearest = 32;

  /// \param points N points of `dimension` coordinates each, side by side; copied
  void build(std::span<const double> points, int dimension);

  /// Points that are left.
  [[nodiscard]] std::size_t size() const { return nodes_.empty() ? 0 : nodes_[0].alive; }
  /// At least one must be left. The lowest number among equals.
  [[nodiscard]] std::uint32_t farthest(const double* x) const;
  /// The k nearest that are left (or all), nearest first. \param k at most kMostNearest
  void nearest(const double* x, std::size_t k, std::vector<std::uint32_t>& result) const;
  /// \param point one that is left
  void remove(std::uint32_t point);

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::uint32_t kFew = 160, kLeaf = 12;  ///< largest leaf of a tree of few points, and of others
  using LeafBuffer = std::array<double, kFew>;
  struct Node {
    std::uint32_t begin;  ///< first place
    std::uint32_t alive;  ///< points that are left; in a leaf they come first
    std::uint32_t parent;
    std::uint32_t left = kNone, right = kNone;  ///< nodes; none of a leaf
  };
  [[nodiscard]] double* box(std::uint32_t node) { return boxes_.data() + node * 2 * dimension_; }
  [[nodiscard]] const double* box(std::uint32_t node) const { return boxes_.data() + node * 2 * dimension_; }
  std::uint32_t grow(std::uint32_t begin, std::uint32_t end, std::uint32_t parent, std::span<const double> points);
  void fit_box(std::uint32_t node);
  [[nodiscard]] std::span<const double> distances(const double* x, const Node& leaf, LeafBuffer& buffer) const;
  [[nodiscard]] double nearest_of_box(const double* x, std::uint32_t node) const;
  [[nodiscard]] double farthest_of_box(const double* x, std::uint32_t node) const;
  /// Squared distance with the place in its last bits: one integer to compare, and to tell equal ones apart.
  static constexpr std::uint64_t kPlaceBits = (1u << 24) - 1;
  using Keys = std::array<std::uint64_t, kMostNearest>;
  void search_nearest(const double* x, std::size_t k, std::uint32_t node, Keys& best) const;
  struct Farthest {
    double squared;
    std::uint32_t point;
  };
  void search_farthest(const double* x, std::uint32_t node, Farthest& best) const;

  std::size_t dimension_ = 1;
  std::uint32_t leaf_size_ = 0;
  std::vector<Node> nodes_;  ///< the first is the root
  std::vector<double> boxes_;
  std::vector<std::uint32_t> points_;   ///< by place
  std::vector<double> coordinates_;     ///< by place
  std::vector<std::uint32_t> places_;   ///< by point
  std::vector<std::uint32_t> leaf_of_;  ///< by point
};

}  // namespace noctule::particle
