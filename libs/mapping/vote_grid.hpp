#pragma once
/// A rectangle of votes that answers quickly where the most are.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace noctule::mapping {

/// Votes in rows of equal length, contiguous. Knows for each row a bound that no vote in it exceeds; a search counts
/// anew only rows whose bound promises more than what it has found.
class VoteGrid {
 public:
  struct Peak {
    int row = -1;  ///< -1: none
    int column = -1;
    float votes = 0.0F;
  };

  VoteGrid() = default;
  VoteGrid(int rows, int columns)
      : columns_(columns),
        votes_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), 0.0F),
        bound_(static_cast<std::size_t>(rows), 0.0F),
        restricted_(static_cast<std::size_t>(rows), 0) {}

  [[nodiscard]] int rows() const { return static_cast<int>(bound_.size()); }
  [[nodiscard]] int columns() const { return columns_; }

  void add(int row, int column, float votes) {
    float& cell = votes_[index(row, column)];
    cell += votes;
    raise(row, cell);
  }
  /// Adds to the cells from `first` on.
  template <int N>
  void add(int row, int first, const Eigen::Array<float, N, 1>& votes) {
    Eigen::Map<Eigen::Array<float, N, 1>> cells(votes_.data() + index(row, first));
    cells += votes;
    raise(row, cells.maxCoeff());
  }

  /// Leaves cells [first, last] of a row out of `best`, until `allow_all`.
  void forbid(int row, int first, int last) {
    forbidden_.push_back({row, std::max(first, 0), std::min(last, columns_ - 1)});
    restricted_[static_cast<std::size_t>(row)] = 1;
  }
  void allow_all() {
    for (const Stretch& f : forbidden_) bound_[static_cast<std::size_t>(f.row)] = std::numeric_limits<float>::max();
    forbidden_.clear();
    std::fill(restricted_.begin(), restricted_.end(), std::uint8_t{0});
  }

  /// The cell with the most votes, more than `threshold`; the first of equals.
  [[nodiscard]] Peak best(float threshold) {
    if (bound_.empty()) return {};
    const auto promising = static_cast<int>(std::max_element(bound_.begin(), bound_.end()) - bound_.begin());
    const float least = row_peak(promising).votes;
    Peak best{.votes = threshold};
    for (int r = 0; r < rows(); ++r) {
      float& bound = bound_[static_cast<std::size_t>(r)];
      if (bound < least || bound <= best.votes) continue;
      const Peak peak = row_peak(r);
      bound = peak.votes;
      if (peak.votes > best.votes) best = peak;
    }
    return best;
  }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  void raise(int row, float votes) {
    float& bound = bound_[static_cast<std::size_t>(row)];
    bound = std::max(bound, votes);
  }

  [[nodiscard]] Peak row_peak(int r) const {
    Peak peak{.row = r};
    const std::size_t stretches = restricted_[static_cast<std::size_t>(r)] != 0 ? forbidden_.size() : 0;
    int from = 0;
    while (from < columns_) {  // over the stretches between forbidden ones
      int to = columns_, next = columns_;
      for (std::size_t k = 0; k < stretches; ++k) {
        const Stretch& f = forbidden_[k];
        if (f.row != r || f.last < from || f.first >= to) continue;
        to = std::max(f.first, from);
        next = f.last + 1;
      }
      const float* cells = votes_.data() + index(r, 0);
      const float most = maximum(cells + from, cells + to);
      if (most > peak.votes) {
        peak.votes = most;
        peak.column = static_cast<int>(std::find(cells + from, cells + to, most) - cells);
      }
      from = next;
    }
    return peak;
  }

  /// Of [first, last) and 0: eight maxima side by side, which the vector unit does at once.
  static float maximum(const float* first, const float* last) {
    constexpr std::ptrdiff_t kLanes = 8;
    std::array<float, kLanes> lanes{};
    for (; last - first >= kLanes; first += kLanes) {
      for (std::size_t k = 0; k < kLanes; ++k) lanes[k] = first[k] > lanes[k] ? first[k] : lanes[k];
    }
    for (; first != last; ++first) lanes[0] = std::max(lanes[0], *first);
    return *std::max_element(lanes.begin(), lanes.end());
  }

  struct Stretch {
    int row;
    int first;
    int last;
  };

  int columns_ = 0;
  std::vector<float> votes_;
  std::vector<float> bound_;              // of the votes of each row that are not forbidden
  std::vector<std::uint8_t> restricted_;  // rows with forbidden cells
  std::vector<Stretch> forbidden_;
};

}  // namespace noctule::mapping
