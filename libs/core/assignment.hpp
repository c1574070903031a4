#pragma once
/// Optimal assignment of rows to columns.
#include <Eigen/Core>
#include <vector>

namespace noctule {

/// Minimum-cost assignment (shortest augmenting paths with potentials, Jonker and Volgenant 1987; O(n^2 m)).
/// \param cost rows x columns; +inf forbids a pair; no NaN.
/// \return for each row its column, or -1 where the row stays free: a pair costs less than staying free only if its
///         cost is below `cost_of_free` (+inf: assign as many rows as possible).
/// \throws std::invalid_argument on NaN.
[[nodiscard]] std::vector<int> assign(const Eigen::MatrixXd& cost, double cost_of_free);

}  // namespace noctule
