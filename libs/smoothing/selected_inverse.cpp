#include "smoothing/selected_inverse.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <stdexcept>
#include <vector>

namespace noctule::smoothing {

using Sparse = Eigen::SparseMatrix<double>;

SelectedInverse::SelectedInverse(const Sparse& information) {
  if (information.rows() == 0) return;
  const Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> factor(information);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0.0)) {
    throw std::domain_error("information matrix is not positive definite");
  }
  place_ = factor.permutationP().indices();
  diagonal_ = factor.vectorD().cwiseInverse();
  inverse_ = factor.matrixL().nestedExpression();  // L without its unit diagonal; turned into the inverse in place

  // Z = D^-1 L^-1 + (I - L') Z, from the last column to the first: what the right side needs is known by then and lies
  // in the pattern of L, because all rows of a column of L are coupled with each other.
  std::vector<int> entry_of_row(static_cast<std::size_t>(diagonal_.size()), -1);
  std::vector<double> z;
  for (Eigen::Index j = diagonal_.size() - 1; j >= 0; --j) {
    const int* rows = inverse_.innerIndexPtr() + inverse_.outerIndexPtr()[j];
    double* column = inverse_.valuePtr() + inverse_.outerIndexPtr()[j];
    const int n = inverse_.outerIndexPtr()[j + 1] - inverse_.outerIndexPtr()[j];
    z.assign(static_cast<std::size_t>(n), 0.0);
    for (int a = 0; a < n; ++a) entry_of_row[static_cast<std::size_t>(rows[a])] = a;
    for (int a = 0; a < n; ++a) {
      z[static_cast<std::size_t>(a)] -= diagonal_[rows[a]] * column[a];
      for (Sparse::InnerIterator it(inverse_, rows[a]); it; ++it) {
        const int b = entry_of_row[static_cast<std::size_t>(it.row())];
        if (b < 0) continue;
        z[static_cast<std::size_t>(b)] -= it.value() * column[a];
        z[static_cast<std::size_t>(a)] -= it.value() * column[b];
      }
    }
    for (int a = 0; a < n; ++a) {
      diagonal_[j] -= column[a] * z[static_cast<std::size_t>(a)];
      entry_of_row[static_cast<std::size_t>(rows[a])] = -1;
    }
    std::copy(z.begin(), z.end(), column);
  }
}

double SelectedInverse::operator()(int row, int column) const {
  const int i = place_[row], j = place_[column];
  return i == j ? diagonal_[i] : inverse_.coeff(std::max(i, j), std::min(i, j));
}

}  // namespace noctule::smoothing
