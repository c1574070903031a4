#pragma once
/// The limit of linear-Gaussian models: Kalman filter and Rauch-Tung-Striebel smoother (Rauch, Tung and Striebel 1965;
/// Särkkä, Bayesian Filtering and Smoothing, section 8.2).
#include <vector>

#include "core/gaussian.hpp"

namespace noctule::smoothing {

template <int D>
struct Gaussian {
  VectorD<D> mean = VectorD<D>::Zero();
  MatrixD<D> covariance = MatrixD<D>::Identity();
};

/// Filters x' = F x + u + w, z = H x + v, and remembers what the smoother needs. Times are numbered from 0, the
/// prior's; each predict() begins the next.
/// \tparam D dimension of the state
template <int D>
class KalmanSmoother {
 public:
  explicit KalmanSmoother(const Gaussian<D>& prior) : times_{{MatrixD<D>::Identity(), prior, prior}} {}

  /// \param f transition F, \param q covariance of w (may be singular), \param u known drive
  void predict(const MatrixD<D>& f, const MatrixD<D>& q, const VectorD<D>& u = VectorD<D>::Zero()) {
    const Gaussian<D>& before = times_.back().filtered;
    Gaussian<D> predicted{f * before.mean + u, f * before.covariance * f.transpose() + q};
    symmetrise(predicted.covariance);
    times_.push_back({f, predicted, predicted});
  }

  /// One of any number of measurements of the present time. \param r covariance of v, positive definite
  template <int M>
  UpdateResult update(const VectorD<M>& z, const Eigen::Matrix<double, M, D>& h, const MatrixD<M>& r) {
    Gaussian<D>& now = times_.back().filtered;
    return joseph_update<D, M>(now.mean, now.covariance, z - h * now.mean, h, r);
  }

  /// State given all measurements so far.
  [[nodiscard]] const Gaussian<D>& estimate() const { return times_.back().filtered; }

  /// State at every time given the measurements up to that time.
  [[nodiscard]] std::vector<Gaussian<D>> filtered() const {
    std::vector<Gaussian<D>> states;
    for (const Time& t : times_) states.push_back(t.filtered);
    return states;
  }

  /// State at every time given all measurements.
  /// \throws std::domain_error where a predicted covariance is singular
  [[nodiscard]] std::vector<Gaussian<D>> smoothed() const {
    std::vector<Gaussian<D>> states = filtered();
    for (std::size_t k = times_.size() - 1; k-- > 0;) {
      const Time& next = times_[k + 1];
      const auto llt = cholesky<D>(next.predicted.covariance);
      const MatrixD<D> gain = llt.solve(next.transition * states[k].covariance).transpose();
      states[k].mean += gain * (states[k + 1].mean - next.predicted.mean);
      states[k].covariance += gain * (states[k + 1].covariance - next.predicted.covariance) * gain.transpose();
      symmetrise(states[k].covariance);
    }
    return states;
  }

 private:
  struct Time {
    MatrixD<D> transition;  ///< from the time before
    Gaussian<D> predicted;
    Gaussian<D> filtered;
  };
  std::vector<Time> times_;
};

}  // namespace noctule::smoothing
