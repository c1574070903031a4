#include "sensors/ultrasonic/surface_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "models/ultrasonic.hpp"

namespace noctule::sensors {
namespace {

constexpr int kMaxRows = 2 * kMaxSightings;
constexpr int kMaxIterations = 20;
constexpr double kConverged = 1e-6;      ///< squared length of the last step in standard deviations of the result
constexpr double kSuspicious = 3.0;      ///< standardised deletion residual from which on an outlier is considered
constexpr double kHopeless = 12.0;       ///< chi2 per residual beyond which no outlier model saves a surface
constexpr int kPatience = 2;             ///< iterations after which a hopeless fit is given up
constexpr double kNearestCentre = 1e-4;  ///< no surface is fitted around the sensor itself [m]

using Factors = std::array<double, kMaxSightings>;  ///< by which the range variances are multiplied

struct WallModel {
  static constexpr int kSize = 2;
  static constexpr bool kHasRadius = false;
  static models::EchoPrediction<2> predict(const Vector2& sensor, const Vector2& x) {
    return models::predict_echo(sensor, Wall{x[0], x[1]});
  }
  /// log of the area that a unit of (range, direction) at `sensor` covers in the parameters
  static double log_volume(const Vector2&, const Vector2&) { return 0.0; }
};

struct CylinderModel {
  static constexpr int kSize = 3;
  static constexpr bool kHasRadius = true;
  static models::EchoPrediction<3> predict(const Vector2& sensor, const Vector3& x) {
    return models::predict_echo(sensor, Cylinder{x.head<2>(), x[2]});
  }
  static double log_volume(const Vector2& sensor, const Vector3& x) { return std::log((x.head<2>() - sensor).norm()); }
};

struct PointModel {
  static constexpr int kSize = 2;
  static constexpr bool kHasRadius = false;
  static models::EchoPrediction<2> predict(const Vector2& sensor, const Vector2& x) {
    const auto full = models::predict_echo(sensor, Cylinder{x, 0.0});
    models::EchoPrediction<2> e;
    e.range = full.range;
    e.direction = full.direction;
    e.range_by_position = full.range_by_position;
    e.range_by_feature = full.range_by_feature.head<2>();
    e.direction_by_position = full.direction_by_position;
    e.direction_by_feature = full.direction_by_feature.head<2>();
    return e;
  }
  static double log_volume(const Vector2& sensor, const Vector2& x) { return std::log((x - sensor).norm()); }
};

/// Generalised least squares of up to kMaxRows residuals: the lower triangle of their covariance C = L L', and below it
/// residuals and Jacobian as further rows, all of which one Cholesky factorisation whitens. Columns are contiguous.
/// (Eigen's solvers of run-time size were measured to take about twice as long for the six residuals of a triple.)
template <int D>
class LeastSquares {
 public:
  void reset(int rows) { rows_ = rows; }
  [[nodiscard]] double& covariance(int i, int j) { return a_[j][i]; }  ///< i >= j
  [[nodiscard]] double& residual(int j) { return a_[j][rows_]; }
  [[nodiscard]] double& jacobian(int j, int parameter) { return a_[j][rows_ + 1 + parameter]; }

  /// \return false when the covariance is not positive definite
  [[nodiscard]] bool whiten() {
    const int length = rows_ + 1 + D;
    for (int j = 0; j < rows_; ++j) {
      double* column = a_[j];
      if (!(column[j] > 0.0)) return false;
      const double pivot = std::sqrt(column[j]), inverse = 1.0 / pivot;
      column[j] = pivot;
      for (int i = j + 1; i < length; ++i) column[i] *= inverse;
      for (int k = j + 1; k < rows_; ++k) {
        double* other = a_[k];
        const double factor = column[k];
        for (int i = k; i < length; ++i) other[i] -= factor * column[i];
      }
    }
    return true;
  }

  // After whiten():
  [[nodiscard]] double chi2() const {
    double sum = 0.0;
    for (int j = 0; j < rows_; ++j) sum += a_[j][rows_] * a_[j][rows_];
    return sum;
  }
  [[nodiscard]] double log_determinant() const {
    double product = 1.0;  // of at most 32 standard deviations: far from underflow
    for (int j = 0; j < rows_; ++j) product *= a_[j][j];
    return 2.0 * std::log(product);
  }
  void normal_equations(MatrixD<D>& information, VectorD<D>& gradient) const {
    information.setZero();
    gradient.setZero();
    for (int j = 0; j < rows_; ++j) {
      const Eigen::Map<const VectorD<D>> h(&a_[j][rows_ + 1]);
      information += h * h.transpose();
      gradient += h * a_[j][rows_];
    }
  }
  /// Residual of each row against all others, standardised: (P e)_i / sqrt(P_ii) with
  /// P = V - V H (H'VH)^-1 H'V, V = C^-1 (valid at the least-squares solution, where H'Ve = 0).
  [[nodiscard]] std::array<double, kMaxRows> deletion_residuals(const MatrixD<D>& covariance) const {
    std::array<double, kMaxRows> result{};
    double column[kMaxRows];  // of L^-1
    for (int i = 0; i < rows_; ++i) {
      double v = 0.0, ve = 0.0;
      VectorD<D> vh = VectorD<D>::Zero();
      for (int k = i; k < rows_; ++k) {
        double sum = k == i ? 1.0 : 0.0;
        for (int m = i; m < k; ++m) sum -= a_[m][k] * column[m];
        column[k] = sum / a_[k][k];
        v += column[k] * column[k];
        ve += column[k] * a_[k][rows_];
        vh += column[k] * Eigen::Map<const VectorD<D>>(&a_[k][rows_ + 1]);
      }
      result[static_cast<std::size_t>(i)] = ve / std::sqrt(std::max(v - vh.dot(covariance * vh), 1e-12 * v));
    }
    return result;
  }

 private:
  int rows_ = 0;
  double a_[kMaxRows][kMaxRows + 1 + D];
};

[[nodiscard]] bool has_direction(const Sighting& s) {
  return std::isfinite(s.direction_variance);
}

[[nodiscard]] int rows_of(std::span<const Sighting> sightings) {
  int rows = 0;
  for (const Sighting& s : sightings) rows += has_direction(s) ? 2 : 1;
  return rows;
}

/// Residuals of all sightings at x, their Jacobian by the parameters and their covariance.
template <class Model>
void linearise(std::span<const Sighting> sightings, const Factors& factors, const VectorD<Model::kSize>& x,
               LeastSquares<Model::kSize>& out) {
  out.reset(rows_of(sightings));
  double twist[kMaxRows][3];  // residual by the twist of its stop
  double bias[kMaxRows];      // residual by the error that all directions share
  int row = 0;
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    const Sighting& s = sightings[k];
    const auto echo = Model::predict(s.position, x);
    const auto add = [&](double residual, const auto& by_position, double by_turn, const auto& by_feature,
                         double shared_sd, double variance) {
      out.residual(row) = residual;
      for (int d = 0; d < Model::kSize; ++d) out.jacobian(row, d) = by_feature[d];
      twist[row][0] = by_position[0];
      twist[row][1] = by_position[1];
      twist[row][2] = by_position[1] * s.position.x() - by_position[0] * s.position.y() + by_turn;
      bias[row] = shared_sd;
      const Vector3 shared = s.drift * Eigen::Map<const Vector3>(twist[row]);
      for (int j = 0; j <= row; ++j)  // all earlier stops share the twist of this, the later one
        out.covariance(row, j) =
            shared[0] * twist[j][0] + shared[1] * twist[j][1] + shared[2] * twist[j][2] + shared_sd * bias[j];
      out.covariance(row, row) += variance;
      ++row;
    };
    add(s.range - echo.range, echo.range_by_position, 0.0, echo.range_by_feature, 0.0, factors[k] * s.range_variance);
    if (has_direction(s))
      add(wrap(s.direction - echo.direction), echo.direction_by_position, -1.0, echo.direction_by_feature,
          std::sqrt(s.direction_bias_variance), s.direction_variance);
  }
}

/// The maximum for given factors.
template <int D>
struct Solution {
  VectorD<D> x;
  MatrixD<D> covariance;
  double chi2 = 0.0;
  double log_determinant = 0.0;  ///< of the residuals' covariance
  int suspect = -1;              ///< sighting with the largest range deletion residual beyond kSuspicious, if asked for

  [[nodiscard]] double objective() const { return -0.5 * (chi2 + log_determinant); }
};

/// Sighting that fits the others worst and is no outlier yet; -1: all fit.
template <int D>
[[nodiscard]] int suspect(std::span<const Sighting> sightings, const Factors& factors,
                          const std::array<double, kMaxRows>& deletion) {
  int worst = -1;
  double largest = kSuspicious;
  std::size_t row = 0;
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    if (factors[k] == 1.0 && std::abs(deletion[row]) > largest) {
      largest = std::abs(deletion[row]);
      worst = static_cast<int>(k);
    }
    row += has_direction(sightings[k]) ? 2 : 1;
  }
  return worst;
}

/// Gauss-Newton. The quadratic model of the last iteration, whose step is negligible, gives the result.
template <class Model>
std::optional<Solution<Model::kSize>> solve(std::span<const Sighting> sightings, const Factors& factors,
                                            const VectorD<Model::kSize>& start, const std::optional<RadiusPrior>& prior,
                                            bool seek_outliers) {
  constexpr int D = Model::kSize;
  LeastSquares<D> problem;
  Solution<D> solution;
  solution.x = start;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    linearise<Model>(sightings, factors, solution.x, problem);
    if (!problem.whiten()) return std::nullopt;
    MatrixD<D> information;
    VectorD<D> gradient;
    problem.normal_equations(information, gradient);
    solution.chi2 = problem.chi2();
    if constexpr (Model::kHasRadius) {
      if (prior) {
        const double weight = 1.0 / (prior->sd * prior->sd), off = prior->mean - solution.x[2];
        information(2, 2) += weight;
        gradient[2] += weight * off;
        solution.chi2 += weight * off * off;
      }
    }
    const Eigen::LLT<MatrixD<D>> llt(information);
    if (llt.info() != Eigen::Success) return std::nullopt;
    const VectorD<D> step = llt.solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    const double length2 = step.dot(gradient);
    // A surface cannot jump past the sensors in one step.
    const double size = step.template head<2>().norm(), most = 0.5 * sightings.back().range + 0.1;
    solution.x += size > most ? VectorD<D>(step * (most / size)) : step;
    const bool hopeless = solution.chi2 - length2 > kHopeless * rows_of(sightings);
    if (hopeless && (iteration >= kPatience || length2 <= kConverged)) return std::nullopt;
    if (length2 > kConverged) continue;
    solution.chi2 -= length2;
    solution.covariance = llt.solve(MatrixD<D>::Identity());
    solution.log_determinant = problem.log_determinant();
    if (seek_outliers && solution.chi2 > kSuspicious * kSuspicious)
      solution.suspect = suspect<D>(sightings, factors, problem.deletion_residuals(solution.covariance));
    return solution;
  }
  return std::nullopt;
}

/// The most likely explanation by outliers, found greedily: one sighting after the other, at most a third of them.
template <class Model>
struct Explanation {
  Solution<Model::kSize> solution;
  int outliers = 0;
  double log_price = 0.0;  ///< log probability of the outliers
};
template <class Model>
std::optional<Explanation<Model>> explain(std::span<const Sighting> sightings, const VectorD<Model::kSize>& start,
                                          const std::optional<RadiusPrior>& prior,
                                          const std::optional<OutlierModel>& model) {
  const bool seek = model && model->probability > 0.0 && model->factor > 1.0 && sightings.size() > 3;
  Factors factors;
  factors.fill(1.0);
  auto solution = solve<Model>(sightings, factors, start, prior, seek);
  if (!solution) return std::nullopt;
  Explanation<Model> best{*solution, 0, 0.0};
  while (best.solution.suspect >= 0 && best.outliers < static_cast<int>(sightings.size()) / 3) {
    factors[static_cast<std::size_t>(best.solution.suspect)] = model->factor * model->factor;
    const double price = std::log(model->probability / (1.0 - model->probability));
    solution = solve<Model>(sightings, factors, best.solution.x, prior, true);
    if (!solution || solution->objective() + price < best.solution.objective()) break;
    best = {*solution, best.outliers + 1, best.log_price + price};
  }
  return best;
}

template <class Model>
std::optional<SurfaceFit<Model::kSize>> fit(std::span<const Sighting> sightings, const VectorD<Model::kSize>& start,
                                            const std::optional<RadiusPrior>& prior,
                                            const std::optional<OutlierModel>& outliers) {
  constexpr int D = Model::kSize;
  if (sightings.empty() || sightings.size() > kMaxSightings) return std::nullopt;
  const int rows = rows_of(sightings), numbers = rows + (prior ? 1 : 0);
  if (numbers < D) return std::nullopt;
  const auto found = explain<Model>(sightings, start, prior, outliers);
  if (!found) return std::nullopt;
  const VectorD<D>& x = found->solution.x;
  if constexpr (!std::is_same_v<Model, WallModel>) {
    for (const Sighting& s : sightings)
      if ((x.template head<2>() - s.position).norm() < kNearestCentre) return std::nullopt;
  }
  SurfaceFit<D> result;
  result.parameters = x;
  result.covariance = found->solution.covariance;
  symmetrise(result.covariance);
  result.chi2 = found->solution.chi2;
  result.dof = numbers - D;
  result.outliers = found->outliers;
  result.log_likelihood = found->solution.objective() - 0.5 * numbers * std::log(kTwoPi) + found->log_price;
  if (prior) result.log_likelihood -= std::log(prior->sd);
  const auto spread = Eigen::LLT<MatrixD<D>>(result.covariance);
  if (spread.info() != Eigen::Success) return std::nullopt;
  double log_spread = 0.5 * D * std::log(kTwoPi);
  for (int i = 0; i < D; ++i) log_spread += std::log(spread.matrixLLT()(i, i));
  result.log_evidence = result.log_likelihood + log_spread - Model::log_volume(sightings.front().position, x);
  if (!std::isfinite(result.log_evidence) || !x.allFinite()) return std::nullopt;
  return result;
}

}  // namespace

std::optional<WallFit> fit_wall(std::span<const Sighting> sightings, const Wall& start,
                                const std::optional<OutlierModel>& outliers) {
  auto result = fit<WallModel>(sightings, Vector2(start.rho, start.theta), std::nullopt, outliers);
  if (result) result->parameters[1] = wrap(result->parameters[1]);
  return result;
}

std::optional<PointFit> fit_point(std::span<const Sighting> sightings, const Vector2& start,
                                  const std::optional<OutlierModel>& outliers) {
  return fit<PointModel>(sightings, start, std::nullopt, outliers);
}

std::optional<CylinderFit> fit_cylinder(std::span<const Sighting> sightings, const Cylinder& start,
                                        const std::optional<RadiusPrior>& prior,
                                        const std::optional<OutlierModel>& outliers) {
  return fit<CylinderModel>(sightings, Vector3(start.centre.x(), start.centre.y(), start.radius), prior, outliers);
}

}  // namespace noctule::sensors
