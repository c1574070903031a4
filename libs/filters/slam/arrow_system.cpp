#include "filters/slam/arrow_system.hpp"

#include <Eigen/Cholesky>
#include <stdexcept>

namespace noctule::filters {
namespace {

Eigen::LLT<Eigen::MatrixXd> decompose(const Eigen::MatrixXd& matrix) {
  Eigen::LLT<Eigen::MatrixXd> llt(matrix);
  if (matrix.size() > 0 && llt.info() != Eigen::Success) throw std::domain_error("landmarks are not determined");
  return llt;
}

}  // namespace

ArrowSystem::ArrowSystem(std::size_t poses, Eigen::Index border)
    : diagonal_(poses),
      coupling_(poses),
      border_(3 * static_cast<Eigen::Index>(poses), border),
      gradient_(3 * static_cast<Eigen::Index>(poses)),
      corner_(border, border),
      corner_gradient_(border) {
  set_zero();
}

void ArrowSystem::set_zero() {
  for (Matrix3& m : diagonal_) m.setZero();
  for (Matrix3& m : coupling_) m.setZero();
  border_.setZero();
  gradient_.setZero();
  corner_.setZero();
  corner_gradient_.setZero();
}

ArrowSystem::Elimination ArrowSystem::eliminate(double damping) const {
  const std::size_t n = diagonal_.size();
  Elimination e{std::vector<Matrix3>(n), std::vector<Matrix3>(n), border_, -gradient_, corner_, -corner_gradient_};
  e.corner.diagonal() *= 1.0 + damping;
  // What earlier poses leave on pose k.
  Matrix3 carried = Matrix3::Zero();
  for (std::size_t k = 0; k < n; ++k) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    Matrix3 d = diagonal_[k];
    d.diagonal() *= 1.0 + damping;
    const Eigen::LLT<Matrix3> llt(d - carried);
    if (llt.info() != Eigen::Success) throw std::domain_error("poses are not determined");
    e.inverse[k] = llt.solve(Matrix3::Identity());
    e.onto_next[k] = e.inverse[k] * coupling_[k];
    const RowMajor border = e.onto_border.middleRows<3>(row);
    const Vector3 rhs = e.rhs.segment<3>(row);
    e.onto_border.middleRows<3>(row).noalias() = e.inverse[k] * border;
    e.rhs.segment<3>(row) = e.inverse[k] * rhs;
    e.corner.noalias() -= border.transpose() * e.onto_border.middleRows<3>(row);
    e.corner_rhs.noalias() -= border.transpose() * e.rhs.segment<3>(row);
    if (k + 1 == n) break;
    carried = coupling_[k].transpose() * e.onto_next[k];
    e.onto_border.middleRows<3>(row + 3).noalias() -= coupling_[k].transpose() * e.onto_border.middleRows<3>(row);
    e.rhs.segment<3>(row + 3).noalias() -= coupling_[k].transpose() * e.rhs.segment<3>(row);
  }
  return e;
}

ArrowSystem::Step ArrowSystem::solve(double damping) const {
  Elimination e = eliminate(damping);
  Step step;
  step.border = decompose(e.corner).solve(e.corner_rhs);
  step.poses = e.rhs - e.onto_border * step.border;
  for (std::size_t k = diagonal_.size() - 1; k-- > 0;) {
    const auto row = 3 * static_cast<Eigen::Index>(k);
    step.poses.segment<3>(row) -= e.onto_next[k] * step.poses.segment<3>(row + 3);
  }
  return step;
}

ArrowSystem::Covariance ArrowSystem::covariance() const {
  const Elimination e = eliminate(0.0);
  const std::size_t n = diagonal_.size();
  Covariance c;
  c.border = decompose(e.corner).solve(Eigen::MatrixXd::Identity(e.corner.rows(), e.corner.cols()));
  c.poses.resize(n);
  RowMajor cross = RowMajor::Zero(3, c.border.cols());  // of pose k + 1 with the border
  Matrix3 next = Matrix3::Zero();
  for (std::size_t k = n; k-- > 0;) {
    const RowMajor onto_border = e.onto_border.middleRows<3>(3 * static_cast<Eigen::Index>(k));
    const Matrix3 onto_next = k + 1 < n ? e.onto_next[k] : Matrix3::Zero();
    const Matrix3 mixed = onto_next * cross * onto_border.transpose();
    next = e.inverse[k] + onto_next * next * onto_next.transpose() + mixed + mixed.transpose() +
           onto_border * c.border * onto_border.transpose();
    cross = -(onto_next * cross + onto_border * c.border).eval();
    c.poses[k] = next;
  }
  return c;
}

}  // namespace noctule::filters
