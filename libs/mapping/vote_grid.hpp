#pragma once
/// A rectangle of votes that answers quickly where the most are.
#include <algorithm>
#include <array>
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
        stale_(static_cast<std::size_t>(rows), 0) {}

  [[nodiscard]] int rows() const { return static_cast<int>(best_.size()); }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] float at(int row, int column) const { return votes_[index(row, column)]; }

  /// The cells of row `r` and those after it, for writing; every row that is written to must be `touch`ed.
  [[nodiscard]] float* cells(int r) { return votes_.data() + index(r, 0); }
  void touch(int first_row, int last_row) {
    std::fill(stale_.begin() + first_row, stale_.begin() + last_row + 1, std::uint8_t{1});
  }

  /// The cell with the most votes, more than `threshold`, of those that `allowed(row, column)`; first row and column
  /// of equals.
  template <class Allowed>
  [[nodiscard]] Peak best(float threshold, const Allowed& allowed) {
    Peak peak{.votes = threshold};
    for (int r = 0; r < rows(); ++r) {
      if (row_maximum(r) <= peak.votes) continue;
      const float* cells = votes_.data() + index(r, 0);
      for (int c = 0; c < columns_; ++c) {
        if (cells[c] > peak.votes && allowed(r, c)) peak = {r, c, cells[c]};
      }
    }
    return peak;
  }

  void clear() {
    std::fill(votes_.begin(), votes_.end(), 0.0F);
    std::fill(best_.begin(), best_.end(), 0.0F);
    std::fill(stale_.begin(), stale_.end(), 0);
  }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  float row_maximum(int r) {
    const auto i = static_cast<std::size_t>(r);
    if (stale_[i] != 0) {
      const float* cells = votes_.data() + index(r, 0);
      std::array<float, 8> lane{};  // eight maxima side by side, for the vector unit; votes below 0 are rounding
      int c = 0;
      for (; c + 8 <= columns_; c += 8) {
        for (std::size_t k = 0; k < 8; ++k)
          lane[k] = cells[c + static_cast<int>(k)] > lane[k] ? cells[c + static_cast<int>(k)] : lane[k];
      }
      for (; c < columns_; ++c) lane[0] = std::max(lane[0], cells[c]);
      best_[i] = *std::max_element(lane.begin(), lane.end());
      stale_[i] = 0;
    }
    return best_[i];
  }

  int columns_ = 0;
  std::vector<float> votes_;
  std::vector<float> best_;
  std::vector<std::uint8_t> stale_;
};

}  // namespace noctule::mapping
