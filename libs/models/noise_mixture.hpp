#pragma once
/// Noise of a measurement as an estimator believes it, prepared once and asked for many residuals.
#include <array>
#include <cmath>

#include "core/gaussian.hpp"
#include "core/limits.hpp"
#include "core/log_weights.hpp"
#include "core/state_archive.hpp"

namespace noctule::models {

/// Of 1 x 1 and 2 x 2 matrices, without the weight of Eigen/LU.
template <int D>
[[nodiscard]] double small_determinant(const MatrixD<D>& m) {
  static_assert(D == 1 || D == 2);
  if constexpr (D == 1) return m(0, 0);
  if constexpr (D == 2) return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
}
template <int D>
[[nodiscard]] MatrixD<D> small_inverse(const MatrixD<D>& m) {
  MatrixD<D> adjugate;
  if constexpr (D == 1) adjugate(0, 0) = 1.0;
  if constexpr (D == 2) adjugate << m(1, 1), -m(0, 1), -m(1, 0), m(0, 0);
  return adjugate / small_determinant<D>(m);
}

/// A mixture of Student's t distributions, Gaussian where the degrees of freedom are infinite, over residuals of D
/// numbers in units of the nominal noise (whitened: nominal covariance = identity).
template <int D>
class NoiseMixture {
 public:
  static constexpr int kMaxComponents = 4;

  struct Component {
    double weight = 1.0;
    VectorD<D> mean = VectorD<D>::Zero();
    MatrixD<D> scale = MatrixD<D>::Identity();  ///< of the t distribution; its covariance where that is Gaussian
    double dof = kInf;
    MatrixD<D> precision = MatrixD<D>::Identity();  ///< expected inverse covariance: what gains are made of
  };

  /// What a Kalman update shall believe of one residual.
  struct Effective {
    VectorD<D> bias;        ///< mean of the noise
    MatrixD<D> covariance;  ///< inverse of the expected precision
  };

  /// How probable a residual is, and what a Kalman update shall believe of it.
  struct Judgement {
    double log_density;
    Effective effective;
  };

  /// At most kMaxComponents; the weights shall sum to one.
  void add(const Component& c) {
    Prepared& p = components_[static_cast<std::size_t>(size_++)];
    p.mean = c.mean;
    p.scale = c.scale;
    p.precision = c.precision;
    p.gaussian = !std::isfinite(c.dof);
    p.inverse_dof = p.gaussian ? 0.0 : 1.0 / c.dof;
    p.exponent = 0.5 * (c.dof + D);
    p.log_constant = std::log(c.weight) + (p.gaussian ? -0.5 * D * std::log(kTwoPi)
                                                      : std::lgamma(p.exponent) - std::lgamma(0.5 * c.dof) -
                                                            0.5 * D * std::log(c.dof * kPi));
  }

  [[nodiscard]] int size() const { return size_; }

  /// Log density of a residual whose prediction has the covariance `extra` besides (added to each scale, with the same
  /// degrees of freedom: a moment-style approximation for t components, exact for Gaussian ones).
  [[nodiscard]] double log_density(const VectorD<D>& v, const MatrixD<D>& extra = MatrixD<D>::Zero()) const {
    Terms terms;
    const double top = fill(terms, v, extra);
    double sum = 0.0;
    for (int l = 0; l < size_; ++l) sum += std::exp(terms[static_cast<std::size_t>(l)] - top);
    return top + std::log(sum);
  }

  /// From the component responsibilities of this residual, so that a component nobody uses inflates no gain.
  [[nodiscard]] Effective effective(const VectorD<D>& v, const MatrixD<D>& extra = MatrixD<D>::Zero()) const {
    return pooled(v, extra, [](const Prepared& c) { return c.precision; }).effective;
  }

  /// Log density, and the effective noise with each component's precision as Student's t expects it given this
  /// residual: one that is far off moves a mean less.
  [[nodiscard]] Judgement judge(const VectorD<D>& v, const MatrixD<D>& extra) const {
    return pooled(v, extra, [&](const Prepared& c) -> MatrixD<D> {
      if (c.gaussian) return c.precision;
      const VectorD<D> e = v - c.mean;
      const double distance2 = e.dot(small_inverse<D>(c.scale + extra) * e);
      return (1.0 + D * c.inverse_dof) / (1.0 + distance2 * c.inverse_dof) * c.precision;
    });
  }

  /// The Gaussian whose log density has the slope of ours at v: covariance^-1 (v - bias) = -d log_density(v) / dv. With
  /// it, least squares maximise this likelihood (iteratively reweighted).
  [[nodiscard]] Effective reweighted(const VectorD<D>& v) const {
    const auto precision_of = [&v](const Prepared& c) -> MatrixD<D> {
      const MatrixD<D> inverse = small_inverse<D>(c.scale);
      if (c.gaussian) return inverse;
      const double distance2 = (v - c.mean).dot(inverse * (v - c.mean));
      return 2.0 * c.exponent * c.inverse_dof / (1.0 + distance2 * c.inverse_dof) * inverse;
    };
    return pooled(v, MatrixD<D>::Zero(), precision_of).effective;
  }

  /// An upper bound of log_density(v, extra) over all `extra` and all v with v'v >= distance2 (largest eigenvalue of
  /// extra + 1); falls with `distance2`. One number only.
  [[nodiscard]] double log_density_bound(double distance2) const requires(D == 1) {
    double result = -kInf;
    for (int l = 0; l < size_; ++l) {
      const Prepared& c = at(l);
      const double scale = c.scale(0, 0), shift = std::abs(c.mean[0]);
      const double far = std::max(0.0, std::sqrt(distance2) - shift);
      const double q = far * far / std::max(1.0, scale);
      const double tail = c.gaussian ? -0.5 * q : -c.exponent * std::log1p(q * c.inverse_dof);
      result = log_add_exp(result, c.log_constant - 0.5 * std::log(scale) + tail);
    }
    return result;
  }

  void transfer(StateArchive& archive) {
    archive(size_);
    if (size_ < 0 || size_ > kMaxComponents) throw InputError("state: expected a mixture of few components");
    for (int l = 0; l < size_; ++l) {
      Prepared& p = components_[static_cast<std::size_t>(l)];
      archive(p.mean, p.scale, p.precision, p.log_constant, p.inverse_dof, p.exponent, p.gaussian);
    }
  }

 private:
  struct Prepared {
    VectorD<D> mean = VectorD<D>::Zero();
    MatrixD<D> scale = MatrixD<D>::Identity(), precision = MatrixD<D>::Identity();
    double log_constant = 0.0, inverse_dof = 0.0, exponent = 0.0;
    bool gaussian = true;
  };
  [[nodiscard]] const Prepared& at(int l) const { return components_[static_cast<std::size_t>(l)]; }

  using Terms = std::array<double, kMaxComponents>;

  /// Log of the weighted density of each component. \return the largest
  double fill(Terms& terms, const VectorD<D>& v, const MatrixD<D>& extra) const {
    double top = -kInf;
    for (int l = 0; l < size_; ++l) {
      terms[static_cast<std::size_t>(l)] = term(at(l), v, extra);
      top = std::max(top, terms[static_cast<std::size_t>(l)]);
    }
    return top;
  }

  /// Log density; mean and covariance from precisions weighted by the components' responsibilities for v.
  template <class Precision>
  [[nodiscard]] Judgement pooled(const VectorD<D>& v, const MatrixD<D>& extra, Precision precision_of) const {
    Terms terms;
    const double top = fill(terms, v, extra);
    double sum = 0.0;
    MatrixD<D> precision = MatrixD<D>::Zero();
    VectorD<D> weighted = VectorD<D>::Zero();
    for (int l = 0; l < size_; ++l) {
      const double r = std::exp(terms[static_cast<std::size_t>(l)] - top);
      const MatrixD<D> own = precision_of(at(l));
      sum += r;
      precision += r * own;
      weighted += r * (own * at(l).mean);
    }
    const MatrixD<D> covariance = small_inverse<D>(precision);
    return {top + std::log(sum), {covariance * weighted, sum * covariance}};
  }

  [[nodiscard]] static double term(const Prepared& c, const VectorD<D>& v, const MatrixD<D>& extra) {
    const VectorD<D> e = v - c.mean;
    const MatrixD<D> s = c.scale + extra;
    const double distance2 = e.dot(small_inverse<D>(s) * e);
    // log(1 + x), not the slower log1p: near 0 its absolute error is what matters, and that is tiny.
    const double tail = c.gaussian ? -0.5 * distance2 : -c.exponent * std::log(1.0 + distance2 * c.inverse_dof);
    return c.log_constant - 0.5 * std::log(small_determinant<D>(s)) + tail;
  }

  std::array<Prepared, kMaxComponents> components_;
  int size_ = 0;
};

}  // namespace noctule::models
