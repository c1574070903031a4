#pragma once
/// Normal equations of a chain of poses that share landmarks: block tridiagonal with a border (an arrow), solved in
/// time linear in the length of the chain.
#include <Eigen/Core>
#include <vector>

#include "core/pose2.hpp"

namespace noctule::filters {

/// H d = -g over poses (3 numbers each, in order) and a border of m numbers.
class ArrowSystem {
 public:
  ArrowSystem(std::size_t poses, Eigen::Index border);

  void set_zero();
  [[nodiscard]] std::size_t poses() const { return diagonal_.size(); }
  [[nodiscard]] Matrix3& diagonal(std::size_t k) { return diagonal_[k]; }
  /// Pose k (rows) with pose k + 1.
  [[nodiscard]] Matrix3& coupling(std::size_t k) { return coupling_[k]; }
  /// Pose k (rows) with the border.
  [[nodiscard]] auto border(std::size_t k) { return border_.middleRows<3>(3 * static_cast<Eigen::Index>(k)); }
  [[nodiscard]] auto gradient(std::size_t k) { return gradient_.segment<3>(3 * static_cast<Eigen::Index>(k)); }
  [[nodiscard]] Eigen::MatrixXd& corner() { return corner_; }
  [[nodiscard]] Eigen::VectorXd& corner_gradient() { return corner_gradient_; }

  struct Step {
    Eigen::VectorXd poses;
    Eigen::VectorXd border;
  };
  /// \param damping the diagonal of H is taken 1 + damping times (Levenberg and Marquardt)
  /// \throws std::domain_error unless H is positive definite
  [[nodiscard]] Step solve(double damping) const;

  struct Covariance {
    std::vector<Matrix3> poses;  ///< marginal
    Eigen::MatrixXd border;
  };
  /// Blocks of H^-1. \throws std::domain_error unless H is positive definite
  [[nodiscard]] Covariance covariance() const;

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// The chain eliminated from its beginning: pose k = rhs_k - onto_next_k pose_k+1 - onto_border_k border.
  struct Elimination {
    std::vector<Matrix3> inverse, onto_next;
    RowMajor onto_border;
    Eigen::VectorXd rhs;
    Eigen::MatrixXd corner;
    Eigen::VectorXd corner_rhs;
  };
  [[nodiscard]] Elimination eliminate(double damping) const;

  std::vector<Matrix3> diagonal_, coupling_;
  RowMajor border_;
  Eigen::VectorXd gradient_;
  Eigen::MatrixXd corner_;
  Eigen::VectorXd corner_gradient_;
};

}  // namespace noctule::filters
