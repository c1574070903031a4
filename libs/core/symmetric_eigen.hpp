#pragma once
#include <Eigen/Core>

namespace noctule {

/// Eigenvalues in increasing order, and the orthonormal eigenvectors as columns.
template <int D>
struct SymmetricEigen {
  Eigen::Matrix<double, D, 1> values;
  Eigen::Matrix<double, D, D> vectors;
};

/// Eigen-decomposition of a symmetric matrix (only its lower half is read). Made for D = 2 and 3 in the source file, so
/// that no other file compiles the solver, which takes seconds.
template <int D>
[[nodiscard]] SymmetricEigen<D> symmetric_eigen(const Eigen::Matrix<double, D, D>& matrix);

extern template SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix<double, 2, 2>&);
extern template SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix<double, 3, 3>&);

}  // namespace noctule
