#include "filters/slam/joint_compatibility.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/chi2.hpp"
#include "core/limits.hpp"

namespace noctule::filters {
namespace {

class Search {
 public:
  Search(std::span<const Pairing> pairings, const Eigen::VectorXd& innovations, const Eigen::MatrixXd& covariance,
         double probability, std::size_t most_steps)
      : pairings_(pairings), innovations_(innovations), covariance_(covariance), steps_left_(most_steps) {
    for (std::size_t k = 0; k < pairings.size(); ++k) {
      if (k == 0 || pairings[k].sighting != pairings[k - 1].sighting) first_.push_back(k);
    }
    const std::size_t rows = first_.size();
    first_.push_back(pairings.size());
    bounds_.assign(2 * rows + 1, 0.0);
    for (std::size_t n = 1; n < bounds_.size(); ++n) bounds_[n] = chi2_quantile(probability, static_cast<double>(n));
    const auto size = static_cast<Eigen::Index>(2 * rows);
    factor_ = Eigen::MatrixXd::Zero(size, size);
    whitened_ = Eigen::VectorXd::Zero(size);
  }

  std::vector<std::size_t> run() {
    descend(0, 0.0, 0);
    return best_;
  }

 private:
  [[nodiscard]] std::size_t rows() const { return first_.size() - 1; }

  void descend(std::size_t row, double distance2, int numbers) {
    if (row == rows()) {
      if (set_.size() > best_.size() || (set_.size() == best_.size() && distance2 < best_distance2_)) {
        best_ = set_;
        best_distance2_ = distance2;
      }
      return;
    }
    if (set_.size() + rows() - row < best_.size() || steps_left_ == 0) return;
    --steps_left_;
    for (std::size_t k = first_[row]; k < first_[row + 1]; ++k) {
      if (std::ranges::any_of(set_, [&](std::size_t j) { return pairings_[j].landmark == pairings_[k].landmark; })) {
        continue;
      }
      const double more = append(k);
      const int with = numbers + pairings_[k].numbers;
      if (!(distance2 + more <= bounds_[static_cast<std::size_t>(with)])) continue;
      set_.push_back(k);
      descend(row + 1, distance2 + more, with);
      set_.pop_back();
    }
    descend(row + 1, distance2, numbers);
  }

  /// Extends the Cholesky factor of the present set by a pairing. \return what it adds to the squared length
  double append(std::size_t k) {
    const auto n = static_cast<Eigen::Index>(2 * set_.size()), at = static_cast<Eigen::Index>(2 * k);
    Eigen::MatrixXd cross(n, 2);
    for (std::size_t j = 0; j < set_.size(); ++j) {
      cross.middleRows<2>(static_cast<Eigen::Index>(2 * j)) =
          covariance_.block<2, 2>(static_cast<Eigen::Index>(2 * set_[j]), at);
    }
    factor_.topLeftCorner(n, n).triangularView<Eigen::Lower>().solveInPlace(cross);
    const Eigen::Matrix2d rest = covariance_.block<2, 2>(at, at) - cross.transpose() * cross;
    const Eigen::LLT<Eigen::Matrix2d> llt(rest);
    if (llt.info() != Eigen::Success) return kInf;
    factor_.block(n, 0, 2, n) = cross.transpose();
    factor_.block<2, 2>(n, n) = llt.matrixL();
    whitened_.segment<2>(n) = llt.matrixL().solve(innovations_.segment<2>(at) - cross.transpose() * whitened_.head(n));
    return whitened_.segment<2>(n).squaredNorm();
  }

  std::span<const Pairing> pairings_;
  const Eigen::VectorXd& innovations_;
  const Eigen::MatrixXd& covariance_;
  std::size_t steps_left_;
  std::vector<std::size_t> first_;  ///< pairing of each sighting, and the end
  std::vector<double> bounds_;      ///< by how many numbers
  Eigen::MatrixXd factor_;          ///< Cholesky factor of the set's covariance
  Eigen::VectorXd whitened_;        ///< the set's innovations, in units of it
  std::vector<std::size_t> set_, best_;
  double best_distance2_ = kInf;
};

}  // namespace

std::vector<std::size_t> jointly_compatible(std::span<const Pairing> pairings, const Eigen::VectorXd& innovations,
                                            const Eigen::MatrixXd& covariance, double probability,
                                            std::size_t most_steps) {
  if (pairings.empty()) return {};
  return Search(pairings, innovations, covariance, probability, most_steps).run();
}

}  // namespace noctule::filters
