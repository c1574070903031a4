#include "core/symmetric_eigen.hpp"

#include <Eigen/Eigenvalues>

namespace noctule {

template <int D>
SymmetricEigen<D> symmetric_eigen(const Eigen::Matrix<double, D, D>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix<double, 2, 2>&);
template SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix<double, 3, 3>&);

}  // namespace noctule
