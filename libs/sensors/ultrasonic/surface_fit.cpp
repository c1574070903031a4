#include "sensors/ultrasonic/surface_fit.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

#include "models/ultrasonic.hpp"

namespace noctule::sensors {
namespace {

constexpr int kMaxRows = 2 * kMaxSightings;
constexpr int kMaxIterations = 20;
constexpr double kConverged = 1e-10;     ///< squared length of a step in standard deviations of the result
constexpr double kSuspicious = 3.0;      ///< standardised deletion residual from which on an outlier is considered
constexpr double kNearestCentre = 1e-4;  ///< no surface is fitted around the sensor itself [m]

template <int Columns>
using Rows =
    Eigen::Matrix<double, Eigen::Dynamic, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor, kMaxRows, Columns>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxRows>;
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

/// Residuals of all sightings at x, their Jacobian by the parameters and their covariance.
template <int D>
struct Linearised {
  Rows<1> residual;
  Rows<D> jacobian;
  Square covariance;
};

[[nodiscard]] int rows_of(std::span<const Sighting> sightings) {
  int rows = 0;
  for (const Sighting& s : sightings) rows += std::isfinite(s.direction_variance) ? 2 : 1;
  return rows;
}

template <class Model>
void linearise(std::span<const Sighting> sightings, const Factors& factors, const VectorD<Model::kSize>& x,
               Linearised<Model::kSize>& out) {
  const int n = rows_of(sightings);
  out.residual.resize(n);
  out.jacobian.resize(n, Model::kSize);
  out.covariance.resize(n, n);
  Rows<3> twist(n, 3);  // residual by the twist of the stop: range by displaced sensor; direction also by the turn
  Rows<1> bias(n);
  int row = 0;
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    const Sighting& s = sightings[k];
    const auto echo = Model::predict(s.position, x);
    const Vector2 turned(-s.position.y(), s.position.x());
    const int first = row;
    out.residual[row] = s.range - echo.range;
    out.jacobian.row(row) = echo.range_by_feature;
    twist.row(row) << echo.range_by_position, echo.range_by_position.dot(turned);
    ++row;
    if (std::isfinite(s.direction_variance)) {
      out.residual[row] = wrap(s.direction - echo.direction);
      out.jacobian.row(row) = echo.direction_by_feature;
      twist.row(row) << echo.direction_by_position, echo.direction_by_position.dot(turned) - 1.0;
      ++row;
    }
    for (int i = first; i < row; ++i) {  // all earlier rows share the twist of this, the later, stop
      const Eigen::RowVector3d shared = twist.row(i) * s.drift;
      bias[i] = i == first ? 0.0 : std::sqrt(s.direction_bias_variance);
      for (int j = 0; j <= i; ++j) out.covariance(i, j) = shared.dot(twist.row(j)) + bias[i] * bias[j];
    }
    out.covariance(first, first) += factors[k] * s.range_variance;
    if (row == first + 2) out.covariance(first + 1, first + 1) += s.direction_variance;
  }
}

/// A fit with given factors, and what the search for outliers needs.
template <int D>
struct Solution {
  VectorD<D> x;
  MatrixD<D> information;
  double chi2 = 0.0;
  double log_determinant = 0.0;  ///< of the residuals' covariance
  int rows = 0;
  Rows<1> deletion;  ///< (P e)_i / sqrt(P_ii), P = V - V H (H'VH)^-1 H'V: residual against all others, standardised
};

template <class Model>
std::optional<Solution<Model::kSize>> solve(std::span<const Sighting> sightings, const Factors& factors,
                                            const VectorD<Model::kSize>& start, const std::optional<RadiusPrior>& prior,
                                            bool with_deletion) {
  constexpr int D = Model::kSize;
  Linearised<D> l;
  Solution<D> solution;
  solution.x = start;
  bool converged = false;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    linearise<Model>(sightings, factors, solution.x, l);
    Eigen::LLT<Eigen::Ref<Square>> llt(l.covariance);
    if (llt.info() != Eigen::Success) return std::nullopt;
    llt.matrixL().solveInPlace(l.residual);
    llt.matrixL().solveInPlace(l.jacobian);
    solution.information = l.jacobian.transpose() * l.jacobian;
    VectorD<D> gradient = l.jacobian.transpose() * l.residual;
    solution.chi2 = l.residual.squaredNorm();
    if constexpr (Model::kHasRadius) {
      if (prior) {
        const double weight = 1.0 / (prior->sd * prior->sd), off = prior->mean - solution.x[2];
        solution.information(2, 2) += weight;
        gradient[2] += weight * off;
        solution.chi2 += weight * off * off;
      }
    }
    const Eigen::LDLT<MatrixD<D>> normal(solution.information);
    if (normal.info() != Eigen::Success || !(normal.rcond() > 1e-14)) return std::nullopt;
    const VectorD<D> step = normal.solve(gradient);
    if (!step.allFinite()) return std::nullopt;
    if (converged) {
      solution.rows = static_cast<int>(l.residual.size());
      solution.log_determinant = 2.0 * l.covariance.diagonal().array().log().sum();
      if (with_deletion) {
        // Whitened: P = L^-T (I - Q) L^-1 with Q the projector on the columns of the whitened Jacobian.
        const Square inverse_factor = llt.matrixL().solve(Square::Identity(solution.rows, solution.rows));
        const Rows<D> weighted = l.jacobian * normal.solve(MatrixD<D>::Identity());
        const Square projector = Square::Identity(solution.rows, solution.rows) - weighted * l.jacobian.transpose();
        const Square p = inverse_factor.transpose() * projector * inverse_factor;
        const Rows<1> pe = inverse_factor.transpose() * l.residual;
        solution.deletion = pe.array() / p.diagonal().array().max(1e-12).sqrt();
      }
      return solution;
    }
    // A surface cannot jump past the sensors in one step.
    const double size = step.template head<2>().norm(), most = 0.5 * sightings.back().range + 0.1;
    solution.x += size > most ? VectorD<D>(step * (most / size)) : step;
    converged = step.dot(gradient) < kConverged;
  }
  return std::nullopt;
}

/// Range row with the largest deletion residual beyond kSuspicious that is not an outlier yet; -1: none.
[[nodiscard]] int most_suspicious(std::span<const Sighting> sightings, const Factors& factors,
                                  const Rows<1>& deletion) {
  int worst = -1;
  double largest = kSuspicious;
  int row = 0;
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    if (factors[k] == 1.0 && std::abs(deletion[row]) > largest) {
      largest = std::abs(deletion[row]);
      worst = static_cast<int>(k);
    }
    row += std::isfinite(sightings[k].direction_variance) ? 2 : 1;
  }
  return worst;
}

template <class Model>
std::optional<SurfaceFit<Model::kSize>> fit(std::span<const Sighting> sightings, const VectorD<Model::kSize>& start,
                                            const std::optional<RadiusPrior>& prior,
                                            const std::optional<OutlierModel>& outliers) {
  constexpr int D = Model::kSize;
  const int rows = rows_of(sightings);
  if (sightings.empty() || sightings.size() > kMaxSightings) return std::nullopt;
  if (rows + (prior && Model::kHasRadius ? 1 : 0) < D) return std::nullopt;

  Factors factors;
  factors.fill(1.0);
  const auto objective = [](const Solution<D>& s) { return -0.5 * (s.chi2 + s.log_determinant); };
  const bool search = outliers && outliers->probability > 0.0 && outliers->factor > 1.0 && sightings.size() > 3;
  auto solution = solve<Model>(sightings, factors, start, prior, false);
  if (!solution) return std::nullopt;
  SurfaceFit<D> result;
  double price = 0.0;
  // No sighting can be kSuspicious while all residuals together are shorter than that.
  if (search && solution->chi2 > kSuspicious * kSuspicious) {
    const double each = std::log(outliers->probability / (1.0 - outliers->probability));
    const int most = static_cast<int>(sightings.size()) / 3;
    solution = solve<Model>(sightings, factors, solution->x, prior, true);
    while (solution && result.outliers < most) {
      const int worst = most_suspicious(sightings, factors, solution->deletion);
      if (worst < 0) break;
      const auto k = static_cast<std::size_t>(worst);
      factors[k] = outliers->factor * outliers->factor;
      const auto without = solve<Model>(sightings, factors, solution->x, prior, true);
      if (!without || objective(*without) + each < objective(*solution)) {
        factors[k] = 1.0;
        break;
      }
      solution = without;
      price += each;
      ++result.outliers;
    }
    if (!solution) return std::nullopt;
  }

  for (const Sighting& s : sightings) {
    if constexpr (Model::kSize == 3 || !std::is_same_v<Model, WallModel>) {
      if ((solution->x.template head<2>() - s.position).norm() < kNearestCentre) return std::nullopt;
    }
  }
  const Eigen::LDLT<MatrixD<D>> normal(solution->information);
  result.parameters = solution->x;
  result.covariance = normal.solve(MatrixD<D>::Identity());
  symmetrise(result.covariance);
  result.chi2 = solution->chi2;
  result.dof = rows - D;
  result.log_likelihood = objective(*solution) - 0.5 * rows * std::log(kTwoPi) + price;
  if constexpr (Model::kHasRadius) {
    if (prior) {
      result.dof += 1;
      result.log_likelihood -= std::log(prior->sd * std::sqrt(kTwoPi));
    }
  }
  const double log_spread = 0.5 * D * std::log(kTwoPi) - 0.5 * normal.vectorD().array().log().sum();
  result.log_evidence = result.log_likelihood + log_spread - Model::log_volume(sightings.front().position, solution->x);
  if (!result.parameters.allFinite() || !result.covariance.allFinite()) return std::nullopt;
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
