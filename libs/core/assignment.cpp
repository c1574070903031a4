#include "core/assignment.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace noctule {

std::vector<int> assign(const Eigen::MatrixXd& cost, double cost_of_free) {
  const auto rows = static_cast<int>(cost.rows());
  const auto columns = static_cast<int>(cost.cols());
  std::vector<int> result(static_cast<std::size_t>(rows), -1);
  if (rows == 0) return result;
  if (cost.array().isNaN().any() || std::isnan(cost_of_free)) throw std::invalid_argument("assign: cost is NaN");

  // Every row gets a column of its own that means "free", so that a solution always exists.
  double largest = 1.0;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      if (std::isfinite(cost(i, j))) largest = std::max(largest, std::abs(cost(i, j)));
    }
  }
  const double big = 4.0 * largest * (rows + columns + 1);
  const double free = std::isfinite(cost_of_free) ? cost_of_free : big;
  const int total = columns + rows;
  const double forbidden = 1e3 * (big + std::abs(free));
  const auto at = [&](int i, int j) {
    if (j < columns) return std::isfinite(cost(i, j)) ? cost(i, j) : forbidden;
    return j - columns == i ? free : forbidden;
  };

  constexpr double inf = std::numeric_limits<double>::infinity();
  std::vector<double> row_potential(static_cast<std::size_t>(rows) + 1, 0.0);
  std::vector<double> column_potential(static_cast<std::size_t>(total) + 1, 0.0);
  std::vector<int> row_of(static_cast<std::size_t>(total) + 1, 0);
  std::vector<int> way(static_cast<std::size_t>(total) + 1, 0);
  for (int i = 1; i <= rows; ++i) {
    row_of[0] = i;
    int j0 = 0;
    std::vector<double> shortest(static_cast<std::size_t>(total) + 1, inf);
    std::vector<char> used(static_cast<std::size_t>(total) + 1, 0);
    do {
      used[static_cast<std::size_t>(j0)] = 1;
      const int i0 = row_of[static_cast<std::size_t>(j0)];
      double delta = inf;
      int j1 = 0;
      for (int j = 1; j <= total; ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (used[k]) continue;
        const double reduced = at(i0 - 1, j - 1) - row_potential[static_cast<std::size_t>(i0)] - column_potential[k];
        if (reduced < shortest[k]) {
          shortest[k] = reduced;
          way[k] = j0;
        }
        if (shortest[k] < delta) {
          delta = shortest[k];
          j1 = j;
        }
      }
      for (int j = 0; j <= total; ++j) {
        const auto k = static_cast<std::size_t>(j);
        if (used[k]) {
          row_potential[static_cast<std::size_t>(row_of[k])] += delta;
          column_potential[k] -= delta;
        } else {
          shortest[k] -= delta;
        }
      }
      j0 = j1;
    } while (row_of[static_cast<std::size_t>(j0)] != 0);
    do {
      const int j1 = way[static_cast<std::size_t>(j0)];
      row_of[static_cast<std::size_t>(j0)] = row_of[static_cast<std::size_t>(j1)];
      j0 = j1;
    } while (j0 != 0);
  }
  for (int j = 1; j <= columns; ++j) {
    const int i = row_of[static_cast<std::size_t>(j)];
    if (i > 0 && std::isfinite(cost(i - 1, j - 1))) result[static_cast<std::size_t>(i - 1)] = j - 1;
  }
  return result;
}

}  // namespace noctule
