#pragma once
/// Whether errors fit the covariances that come with them (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).
#include <Eigen/Cholesky>
#include <limits>
#include <span>
#include <vector>

#include "core/chi2.hpp"
#include "core/estimate.hpp"
#include "core/gaussian.hpp"
#include "core/source.hpp"

namespace noctule::eval {

/// A squared Mahalanobis length: of an estimation error (NEES) or of an innovation (NIS). Chi-square with `dof`
/// degrees of freedom when the covariance is right. NaN where the covariance was not positive definite.
struct NormalisedSquare {
  double value = 0.0;
  int dof = 0;
};

template <int D>
[[nodiscard]] NormalisedSquare normalised_square(const VectorD<D>& error, const MatrixD<D>& covariance) {
  const Eigen::LLT<MatrixD<D>> llt(covariance);
  const auto dof = static_cast<int>(error.size());
  if (llt.info() != Eigen::Success || !covariance.allFinite() || !error.allFinite()) {
    return {std::numeric_limits<double>::quiet_NaN(), dof};
  }
  return {llt.matrixL().solve(error).squaredNorm(), dof};
}

/// NEES of each known landmark that is in the map (points only, by id). The landmarks of one map share the errors of
/// one path: average over runs, not over landmarks.
[[nodiscard]] std::vector<NormalisedSquare> landmark_nees(const LandmarkMap&, std::span<const KnownLandmark>);

/// Values of independent runs at one time. A value that is not finite makes the time inconsistent; it is counted and
/// left out of the mean.
struct ConsistencyStep {
  int runs = 0;               ///< with a finite value
  int failed = 0;             ///< without
  double mean = 0.0;          ///< sum of values / sum of degrees of freedom: 1 is expected; NaN: no run
  Interval bounds{0.0, 0.0};  ///< two-sided, of that mean
  bool inside = false;
};

/// How a filter's covariances fare over independent runs. At each time the runs are averaged and compared with the
/// interval that the average of so many chi-square values keeps with the given probability; a consistent filter is
/// inside at about that share of the times (times of one run are dependent: the share varies more than a binomial).
struct Consistency {
  std::vector<ConsistencyStep> steps;  ///< as long as the longest run
  double mean = 0.0;                   ///< over all times and runs, per degree of freedom; NaN: no value
  double share_inside = 0.0;           ///< of the times; NaN: no time
  double share_above = 0.0;            ///< overconfident times
  double share_below = 0.0;            ///< underconfident times
  int failed = 0;                      ///< values that are not finite
};
/// \param runs one series a run, same times in each; runs may end early; a time of 0 degrees of freedom (a scan that
///        saw nothing) does not count \throws std::invalid_argument unless 0 < probability < 1
[[nodiscard]] Consistency consistency(std::span<const std::vector<NormalisedSquare>> runs, double probability = 0.95);

}  // namespace noctule::eval
