#include "smoothing/landmark_smoother.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <array>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/check.hpp"
#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "core/observation_checks.hpp"
#include "models/range_bearing.hpp"
#include "smoothing/selected_inverse.hpp"

namespace noctule::smoothing {
namespace {

template <class T>
T wrapped(const T& angle) {
  return angle - kTwoPi * floor((angle + kPi) / kTwoPi);
}

/// W with W'W = covariance^-1.
template <int D>
MatrixD<D> root_information(const MatrixD<D>& covariance) {
  return cholesky<D>(covariance).matrixL().solve(MatrixD<D>::Identity());
}

/// W (pose b seen from pose a - measured increment).
struct MotionResidual {
  Pose2 increment;
  Matrix3 root_information;

  template <class T>
  bool operator()(const T* a, const T* b, T* residual) const {
    const T c = cos(a[2]), s = sin(a[2]);
    const T dx = b[0] - a[0], dy = b[1] - a[1];
    const Eigen::Matrix<T, 3, 1> error(c * dx + s * dy - increment.x, c * dy - s * dx - increment.y,
                                       wrapped(b[2] - a[2] - increment.yaw));
    Eigen::Map<Eigen::Matrix<T, 3, 1>>{residual} = root_information.cast<T>() * error;
    return true;
  }
};

/// W (predicted - measured range and bearing).
struct SightingResidual {
  Pose2 sensor_in_base;
  Vector2 z;
  Matrix2 root_information;

  template <class T>
  bool operator()(const T* base, const T* landmark, T* residual) const {
    const T c = cos(base[2]), s = sin(base[2]);
    const T dx = landmark[0] - base[0], dy = landmark[1] - base[1];
    const T x = c * dx + s * dy - sensor_in_base.x, y = c * dy - s * dx - sensor_in_base.y;
    const Eigen::Matrix<T, 2, 1> error(sqrt(x * x + y * y) - z[0], wrapped(atan2(y, x) - sensor_in_base.yaw - z[1]));
    Eigen::Map<Eigen::Matrix<T, 2, 1>>{residual} = root_information.cast<T>() * error;
    return true;
  }
};

ceres::LossFunction* make_loss(const LandmarkSmootherParameters& p) {
  switch (p.loss) {
    case Loss::huber:
      return new ceres::HuberLoss(p.loss_scale);
    case Loss::cauchy:
      return new ceres::CauchyLoss(p.loss_scale);
    case Loss::quadratic:
      break;
  }
  return nullptr;
}

std::array<double, 3> as_block(const Pose2& p) {
  return {p.x, p.y, p.yaw};
}
Pose2 as_pose(const std::array<double, 3>& block) {
  return {block[0], block[1], wrap(block[2])};
}

}  // namespace

/// The unknowns and their equations, grown scan by scan.
class LandmarkProblem {
 public:
  explicit LandmarkProblem(const LandmarkSmoother& input)
      : input_(input),
        poses_(input.motions_.size() + 1),
        landmarks_(input.landmark_of_id_.size()),
        known_(landmarks_.size(), false),
        loss_(make_loss(input.parameters_)),
        problem_(options()) {
    poses_[0] = as_block(input.start_);
    problem_.AddParameterBlock(poses_[0].data(), 3);
    problem_.SetParameterBlockConstant(poses_[0].data());
    add_sightings();
  }

  SmoothedRun solve() {
    SmoothedRun run;
    const LandmarkSmootherParameters& p = input_.parameters_;
    for (std::size_t i = 0; i < input_.motions_.size(); ++i) {
      add_motion(i);
      add_sightings();
      if ((i + 1) % static_cast<std::size_t>(p.batch) == 0)
        run.iterations += minimise(kWayIterations, kWayTolerance).iterations;
    }
    const Outcome last = minimise(p.max_iterations, p.tolerance);
    run.iterations += last.iterations;
    run.converged = last.converged;
    run.dof = problem_.NumResiduals() - problem_.NumParameters() + 3;
    ceres::Problem::EvaluateOptions plain;
    plain.apply_loss_function = false;
    plain.num_threads = 1;
    problem_.Evaluate(plain, &run.chi2, nullptr, nullptr, nullptr);
    run.chi2 *= 2.0;
    read(run);
    return run;
  }

 private:
  struct Outcome {
    int iterations = 0;
    bool converged = false;
  };
  /// Of the solutions on the way: near enough to go on from.
  static constexpr int kWayIterations = 20;
  static constexpr double kWayTolerance = 1e-3;

  static ceres::Problem::Options options() {
    ceres::Problem::Options o;
    o.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;  // shared by all sightings
    return o;
  }

  void add_motion(std::size_t i) {
    const auto& motion = input_.motions_[i];
    poses_[i + 1] = as_block(as_pose(poses_[i]) * motion.increment);
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<MotionResidual, 3, 3, 3>(
                                  new MotionResidual{motion.increment, motion.root_information}),
                              nullptr, poses_[i].data(), poses_[i + 1].data());
    ++nodes_;
  }

  /// Those of the nodes that are there.
  void add_sightings() {
    for (; next_sighting_ < input_.sightings_.size() && input_.sightings_[next_sighting_].node < nodes_;
         ++next_sighting_) {
      const auto& s = input_.sightings_[next_sighting_];
      if (!known_[s.landmark]) {
        known_[s.landmark] = true;
        const Vector2 place = models::place_landmark(as_pose(poses_[s.node]) * s.sensor_in_base, s.z).landmark;
        landmarks_[s.landmark] = {place.x(), place.y()};
      }
      problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<SightingResidual, 2, 3, 2>(
                                    new SightingResidual{s.sensor_in_base, s.z, s.root_information}),
                                loss_.get(), poses_[s.node].data(), landmarks_[s.landmark].data());
    }
  }

  Outcome minimise(int iterations, double tolerance) {
    ceres::Solver::Options o;
    o.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    o.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // no BLAS, whose threads would change the last bits
    o.num_threads = 1;
    o.max_num_iterations = iterations;
    o.function_tolerance = tolerance;
    o.parameter_tolerance = 1e-14;
    o.gradient_tolerance = 1e-14;
    o.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(o, &problem_, &summary);
    return {static_cast<int>(summary.iterations.size()), summary.termination_type == ceres::CONVERGENCE};
  }

  /// Inverse of J'J for poses 1, 2, ... and then the landmarks; nothing where it is singular.
  std::optional<SelectedInverse> covariance() {
    ceres::Problem::EvaluateOptions order;
    order.num_threads = 1;
    for (std::size_t i = 1; i < poses_.size(); ++i) order.parameter_blocks.push_back(poses_[i].data());
    for (auto& l : landmarks_) order.parameter_blocks.push_back(l.data());
    if (order.parameter_blocks.empty()) return SelectedInverse(Eigen::SparseMatrix<double>(0, 0));
    ceres::CRSMatrix crs;
    problem_.Evaluate(order, nullptr, nullptr, nullptr, &crs);
    const Eigen::SparseMatrix<double> j = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
        crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(), crs.cols.data(),
        crs.values.data());
    try {
      return SelectedInverse(j.transpose() * j);
    } catch (const std::domain_error&) {
      return std::nullopt;
    }
  }

  void read(SmoothedRun& run) {
    const std::optional<SelectedInverse> inverse = covariance();
    run.converged = run.converged && inverse;
    const auto block = [&](std::size_t first, auto matrix) {
      for (int r = 0; r < matrix.rows(); ++r) {
        for (int c = 0; c < matrix.cols(); ++c) {
          matrix(r, c) = inverse ? (*inverse)(static_cast<int>(first) + r, static_cast<int>(first) + c)
                                 : std::numeric_limits<double>::quiet_NaN();
        }
      }
      return matrix;
    };
    for (const auto& scan : input_.scans_) {
      run.path.poses.push_back({scan.stamp.seq, scan.stamp.utime, as_pose(poses_[scan.node])});
      run.path_covariances.push_back(scan.node == 0 ? Matrix3(Matrix3::Zero()) : block(3 * (scan.node - 1), Matrix3()));
    }
    std::vector<int> observations(landmarks_.size(), 0);
    for (const auto& s : input_.sightings_) ++observations[s.landmark];
    for (const auto& [id, index] : input_.landmark_of_id_) {
      LandmarkEstimate l;
      l.id = id;
      l.parameters.head<2>() << landmarks_[index][0], landmarks_[index][1];
      l.covariance.topLeftCorner<2, 2>() = block(3 * (poses_.size() - 1) + 2 * index, Matrix2());
      l.observations = observations[index];
      run.map.landmarks.push_back(l);
    }
  }

  const LandmarkSmoother& input_;
  std::vector<std::array<double, 3>> poses_;
  std::vector<std::array<double, 2>> landmarks_;
  std::vector<bool> known_;  ///< landmarks that have been sighted so far
  std::size_t nodes_ = 1;
  std::size_t next_sighting_ = 0;
  std::unique_ptr<ceres::LossFunction> loss_;
  ceres::Problem problem_;
};

LandmarkSmoother::LandmarkSmoother(const LandmarkSmootherParameters& parameters, const Pose2& start)
    : parameters_(parameters), start_(start) {
  require_sound(parameters, "landmark smoother");
  if (!start.finite()) throw InputError("landmark smoother: start: expected a finite pose");
}

void LandmarkSmoother::predict(const Odometry& odometry) {
  check(odometry);
  const PoseGaussian motion{odometry.increment, odometry.covariance};
  pending_ = pending_ ? *pending_ * motion : motion;
}

void LandmarkSmoother::update(const LandmarkDetections& message) {
  check_whole(message);
  for (const LandmarkDetection& d : message.detections) {
    if (d.id < 0) {
      throw InputError("landmark detections " + std::to_string(message.stamp.seq) +
                       ": id: expected the identity of each landmark, got " + std::to_string(d.id) +
                       " (the smoother knows no association of its own)");
    }
  }
  if (pending_) {
    const Vector3 floor(parameters_.position_floor, parameters_.position_floor, parameters_.heading_floor);
    const Matrix3 covariance = pending_->covariance + Matrix3(floor.cwiseAbs2().asDiagonal());
    motions_.push_back({pending_->mean, root_information<3>(covariance)});
    pending_.reset();
  }
  scans_.push_back({message.stamp, motions_.size()});
  for (const LandmarkDetection& d : message.detections) {
    const auto landmark = landmark_of_id_.try_emplace(d.id, landmark_of_id_.size()).first->second;
    sightings_.push_back(
        {motions_.size(), landmark, message.sensor_in_base, {d.range, d.bearing}, root_information<2>(d.covariance)});
  }
}

SmoothedRun LandmarkSmoother::solve() const {
  if (scans_.empty()) return {.converged = true};
  SmoothedRun run = LandmarkProblem(*this).solve();
  run.path.stamp = run.map.stamp = scans_.back().stamp;
  return run;
}

}  // namespace noctule::smoothing
