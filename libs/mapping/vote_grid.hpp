#pragma once
/// A rectangle of votes that answers quickly where the most are.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace noctule::mapping {

/// Votes in rows of equal length, contiguous. Keeps the largest vote of each row and recounts only the rows that
/// changed: taking an object's votes out and asking for the next peak costs what the object covers, not the whole grid.
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
        best_(static_cast<std::size_t>(rows), 0.0F),
        stale_(static_cast<std::size_t>(rows), 0),
        restricted_(static_cast<std::size_t>(rows), 0) {}

  [[nodiscard]] int rows() const { return static_cast<int>(best_.size()); }
  [[nodiscard]] int columns() const { return columns_; }

  /// The cells of row `r` and those after it, for writing; every row that is written to must be `touch`ed.
  [[nodiscard]] float* cells(int r) { return votes_.data() + index(r, 0); }
  void touch(int first_row, int last_row) {
    std::fill(stale_.begin() + first_row, stale_.begin() + last_row + 1, std::uint8_t{1});
  }

  /// Leaves cells [first, last] of a row out of `best`, until `allow_all`.
  void forbid(int row, int first, int last) {
    forbidden_.push_back({row, std::max(first, 0), std::min(last, columns_ - 1)});
    restricted_[static_cast<std::size_t>(row)] = 1;
    touch(row, row);
  }
  void allow_all() {
    for (const Stretch& f : forbidden_) touch(f.row, f.row);
    forbidden_.clear();
    std::fill(restricted_.begin(), restricted_.end(), std::uint8_t{0});
  }

  /// The cell with the most votes, more than `threshold`; the first of equals.
  [[nodiscard]] Peak best(float threshold) {
    Peak peak{.votes = threshold};
    for (int r = 0; r < rows(); ++r) {
      const auto i = static_cast<std::size_t>(r);
      if (stale_[i] != 0) {
        best_[i] = row_peak(r).votes;
        stale_[i] = 0;
      }
      if (best_[i] > peak.votes) {
        peak.row = r;
        peak.votes = best_[i];
      }
    }
    return peak.row < 0 ? peak : row_peak(peak.row);
  }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
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
  std::vector<float> best_;               // of each row
  std::vector<std::uint8_t> stale_;       // rows whose best_ must be found anew
  std::vector<std::uint8_t> restricted_;  // rows with forbidden cells
  std::vector<Stretch> forbidden_;
};

}  // namespace noctule::mapping
