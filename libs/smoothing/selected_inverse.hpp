#pragma once
/// Marginal covariances from a sparse information matrix.
#include <Eigen/SparseCore>

namespace noctule::smoothing {

/// Entries of the inverse of a sparse positive definite matrix, wherever the matrix (or its Cholesky factor) has an
/// entry: the diagonal and the blocks of all variables that share an equation (Takahashi, Fagan and Chen 1973; Erisman
/// and Tinney 1975). Costs about what the factorisation costs; the whole inverse would be dense.
class SelectedInverse {
 public:
  /// \param information symmetric, both triangles present
  /// \throws std::domain_error unless it is positive definite
  explicit SelectedInverse(const Eigen::SparseMatrix<double>& information);

  /// An entry of the inverse; 0 for one that was not computed (no entry of the information matrix there).
  [[nodiscard]] double operator()(int row, int column) const;

 private:
  Eigen::VectorXi place_;                ///< of each variable in the order of elimination
  Eigen::SparseMatrix<double> inverse_;  ///< below the diagonal, in that order
  Eigen::VectorXd diagonal_;
};

}  // namespace noctule::smoothing
