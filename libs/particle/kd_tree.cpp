#include "particle/kd_tree.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

namespace noctule::particle {
namespace {

/// Among the k smallest, in order, without a branch. Positive doubles are ordered as their bits are.
template <class Keys>
[[gnu::always_inline]] inline void insert(std::uint64_t key, std::size_t k, Keys& best) {
  for (std::size_t i = 0; i < k; ++i) {
    const std::uint64_t smaller = std::min(key, best[i]);
    key = std::max(key, best[i]);
    best[i] = smaller;
  }
}

}  // namespace

void KdTree::build(std::span<const double> points, int dimension) {
  dimension_ = static_cast<std::size_t>(dimension);
  const auto n = static_cast<std::uint32_t>(points.size() / dimension_);
  leaf_size_ = n <= kFew ? kFew : kLeaf;
  nodes_.clear();
  boxes_.clear();
  points_.resize(n);
  places_.resize(n);
  leaf_of_.resize(n);
  coordinates_.resize(points.size());
  std::iota(points_.begin(), points_.end(), 0u);
  if (n > 0) grow(0, n, kNone, points);
}

std::uint32_t KdTree::grow(std::uint32_t begin, std::uint32_t end, std::uint32_t parent,
                           std::span<const double> points) {
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({begin, end - begin, parent});
  boxes_.resize(boxes_.size() + 2 * dimension_);
  if (end - begin <= leaf_size_) {
    for (std::uint32_t place = begin; place < end; ++place) {
      const std::uint32_t point = points_[place];
      places_[point] = place;
      leaf_of_[point] = node;
      std::copy_n(points.data() + point * dimension_, dimension_, coordinates_.data() + place * dimension_);
    }
    fit_box(node);
    return node;
  }
  std::size_t widest = 0;
  double width = -1.0;
  for (std::size_t k = 0; k < dimension_; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (std::uint32_t place = begin; place < end; ++place) {
      const double x = points[points_[place] * dimension_ + k];
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (high - low > width) width = high - low, widest = k;
  }
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(points_.begin() + begin, points_.begin() + middle, points_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return points[a * dimension_ + widest] < points[b * dimension_ + widest];
                   });
  const std::uint32_t left = grow(begin, middle, node, points);
  const std::uint32_t right = grow(middle, end, node, points);
  nodes_[node].left = left;
  nodes_[node].right = right;
  fit_box(node);
  return node;
}

/// The box of a leaf from its points, of another node from those of its children.
void KdTree::fit_box(std::uint32_t node) {
  const Node& n = nodes_[node];
  double* const low = box(node);
  double* const high = low + dimension_;
  std::fill_n(low, dimension_, std::numeric_limits<double>::infinity());
  std::fill_n(high, dimension_, -std::numeric_limits<double>::infinity());
  const auto include = [&](const double* a, const double* b) {
    for (std::size_t k = 0; k < dimension_; ++k) {
      low[k] = std::min(low[k], a[k]);
      high[k] = std::max(high[k], b[k]);
    }
  };
  if (n.left == kNone) {
    for (std::uint32_t place = n.begin; place < n.begin + n.alive; ++place) {
      const double* const x = coordinates_.data() + place * dimension_;
      include(x, x);
    }
  } else {
    include(box(n.left), box(n.left) + dimension_);
    include(box(n.right), box(n.right) + dimension_);
  }
}

/// Squared distances of the points left in a leaf: all first, so that choosing among them does not wait for them.
std::span<const double> KdTree::distances(const double* x, const Node& leaf, LeafBuffer& buffer) const {
  const double* y = coordinates_.data() + leaf.begin * dimension_;
  if (dimension_ == 3) {
    for (std::uint32_t i = 0; i < leaf.alive; ++i, y += 3) {
      const double a = x[0] - y[0], b = x[1] - y[1], c = x[2] - y[2];
      buffer[i] = a * a + b * b + c * c;
    }
  } else {
    for (std::uint32_t i = 0; i < leaf.alive; ++i, y += dimension_) {
      double sum = 0.0;
      for (std::size_t k = 0; k < dimension_; ++k) sum += (x[k] - y[k]) * (x[k] - y[k]);
      buffer[i] = sum;
    }
  }
  return std::span(buffer).first(leaf.alive);
}

double KdTree::nearest_of_box(const double* x, std::uint32_t node) const {
  const double* const low = box(node);
  double sum = 0.0;
  for (std::size_t k = 0; k < dimension_; ++k) {
    const double d = std::max({low[k] - x[k], x[k] - low[dimension_ + k], 0.0});
    sum += d * d;
  }
  return sum;
}

double KdTree::farthest_of_box(const double* x, std::uint32_t node) const {
  const double* const low = box(node);
  double sum = 0.0;
  for (std::size_t k = 0; k < dimension_; ++k) {
    const double d = std::max(x[k] - low[k], low[dimension_ + k] - x[k]);
    sum += d * d;
  }
  return sum;
}

std::uint32_t KdTree::farthest(const double* x) const {
  Farthest best{-1.0, 0};
  search_farthest(x, 0, best);
  return best.point;
}

void KdTree::search_farthest(const double* x, std::uint32_t node, Farthest& best) const {
  const Node& n = nodes_[node];
  if (n.left == kNone) {
    LeafBuffer buffer;
    std::uint32_t place = n.begin;
    for (const double d : distances(x, n, buffer)) {
      if (d > best.squared || (d == best.squared && points_[place] < best.point)) best = {d, points_[place]};
      ++place;
    }
    return;
  }
  std::pair<double, std::uint32_t> first{-1.0, n.left}, second{-1.0, n.right};
  for (auto* side : {&first, &second}) {
    if (nodes_[side->second].alive > 0) side->first = farthest_of_box(x, side->second);
  }
  if (first.first < second.first) std::swap(first, second);
  for (const auto& [bound, child] : {first, second}) {
    if (bound >= 0.0 && bound >= best.squared) search_farthest(x, child, best);
  }
}

void KdTree::nearest(const double* x, std::size_t k, std::vector<std::uint32_t>& result) const {
  result.clear();
  k = std::min({k, size(), kMostNearest});
  if (k == 0) return;
  Keys best;
  best.fill(~std::uint64_t{0});
  search_nearest(x, k, 0, best);
  for (std::size_t i = 0; i < k; ++i) result.push_back(points_[best[i] & kPlaceBits]);
}

void KdTree::search_nearest(const double* x, std::size_t k, std::uint32_t node, Keys& best) const {
  const Node& n = nodes_[node];
  if (n.left == kNone) {
    LeafBuffer buffer;
    std::uint64_t place = n.begin;
    for (const double d : distances(x, n, buffer)) {
      const std::uint64_t key = (std::bit_cast<std::uint64_t>(d) & ~kPlaceBits) | place++;
      k == 6 ? insert(key, 6, best) : insert(key, k, best);  // poses: unrolled
    }
    return;
  }
  std::pair<double, std::uint32_t> first{-1.0, n.left}, second{-1.0, n.right};
  for (auto* side : {&first, &second}) {
    if (nodes_[side->second].alive > 0) side->first = nearest_of_box(x, side->second);
  }
  if (first.first > second.first) std::swap(first, second);
  for (const auto& [bound, child] : {first, second}) {
    if (bound >= 0.0 && std::bit_cast<std::uint64_t>(bound) <= best[k - 1]) search_nearest(x, k, child, best);
  }
}

void KdTree::remove(std::uint32_t point) {
  const std::uint32_t leaf = leaf_of_[point], place = places_[point];
  const std::uint32_t last = nodes_[leaf].begin + nodes_[leaf].alive - 1;
  std::swap(points_[place], points_[last]);
  std::swap_ranges(coordinates_.begin() + static_cast<std::ptrdiff_t>(place * dimension_),
                   coordinates_.begin() + static_cast<std::ptrdiff_t>((place + 1) * dimension_),
                   coordinates_.begin() + static_cast<std::ptrdiff_t>(last * dimension_));
  places_[points_[place]] = place;
  places_[point] = last;
  for (std::uint32_t node = leaf; node != kNone; node = nodes_[node].parent) {
    --nodes_[node].alive;
    if (node != 0) fit_box(node);  // that of the root is never asked for
  }
}

}  // namespace noctule::particle
