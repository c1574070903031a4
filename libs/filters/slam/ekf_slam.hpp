#pragma once
/// EKF-SLAM (Smith, Self, Cheeseman 1990): one Gaussian over the pose and all landmarks. The baseline of the landmark
/// filters, and the strongest one while landmarks are few.
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "filters/slam/landmark_association.hpp"
#include "filters/slam/landmark_parameters.hpp"
#include "filters/slam/slam_filter.hpp"

namespace noctule::filters {

/// A prediction costs O(landmarks). An update stacks all sightings of a message, about one linearisation, and costs
/// O(sightings landmarks^2): P -= W W' with W = P H' L^-T, L the Cholesky factor of the innovations' covariance, which
/// keeps P symmetric.
class EkfSlam final : public SlamFilter {
 public:
  /// \param start pose of the base in the map at the first observation, taken as certain
  /// \throws InputError on a start that is not finite or parameters that make no filter
  explicit EkfSlam(const EkfSlamParameters& parameters, const Pose2& start = {});

  void predict(const Odometry& odometry) override;
  /// Bearing-only and range-only sightings update landmarks that range and bearing have begun; they begin none.
  void update(const LandmarkDetections& message) override;
  /// \throws InputError always
  void update(const UltrasonicScan& scan, const ContourFeatures& features) override;

  [[nodiscard]] SlamEstimate estimate() const override { return estimate_; }
  [[nodiscard]] PathEstimate path() const override { return {estimate_.stamp, path_}; }
  [[nodiscard]] LandmarkMap map() const override;
  /// Empty.
  [[nodiscard]] ParticleCloud particles(int) const override { return {estimate_.stamp, {}}; }
  [[nodiscard]] std::int64_t collapses() const override { return collapses_; }
  /// Pose and landmarks are taken as independent.
  void begin_on(const LandmarkMap& map, const ParticleCloud& poses) override;
  void transfer(StateArchive& archive) override;

  /// Covariance of pose and landmarks, (x, y, yaw, x_1, y_1, x_2, ...).
  [[nodiscard]] Eigen::MatrixXd covariance() const { return covariance_.topLeftCorner(size(), size()); }

 private:
  using Jacobian = Eigen::Matrix<double, 2, 5>;  ///< by pose and landmark
  struct Match {
    std::size_t landmark;
    Vector2 innovation;
    Jacobian jacobian;
    Matrix2 noise;
    int numbers;  ///< that the sighting measures; of the other one, innovation and Jacobian are 0 (see Sighting)
  };

  [[nodiscard]] Eigen::Index size() const { return 3 + 2 * static_cast<Eigen::Index>(landmarks_.size()); }
  [[nodiscard]] static Eigen::Index row(std::size_t landmark) { return 3 + 2 * static_cast<Eigen::Index>(landmark); }
  [[nodiscard]] Vector2 position(std::size_t landmark) const { return mean_.segment<2>(row(landmark)); }
  [[nodiscard]] Pose2 pose() const { return {mean_[0], mean_[1], mean_[2]}; }
  [[nodiscard]] Match match(const LandmarkDetection& z, std::size_t landmark) const;
  [[nodiscard]] Matrix2 innovation_covariance(const Match& m) const;
  void associate(const LandmarkDetections& message);
  [[nodiscard]] double distance2(const Match& m) const;
  void associate_unnamed(const LandmarkDetections& message, const std::vector<std::size_t>& rows);
  [[nodiscard]] std::vector<int> match_jointly(const std::vector<std::vector<Match>>& compatible) const;
  void stack(std::span<const Match> matches, Eigen::MatrixXd& pht, Eigen::MatrixXd& s) const;
  void take_in();
  void start(const LandmarkDetection& z, std::int64_t id);
  void live(std::size_t size_before);
  void judge_missed(std::span<const char> seen);
  void merge_duplicates();
  void merge(std::size_t survivor, std::size_t duplicate);
  void remove(std::size_t landmark);

  struct Named {
    std::int64_t id;
    int observations;
    float existence = 0.0f;  ///< log odds
  };

  MatchRule rule_;
  std::optional<LandmarkLifeParameters> life_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;  ///< with room for more landmarks than there are
  std::vector<Named> landmarks_;
  std::unordered_map<std::int64_t, std::size_t> named_;
  Pose2 sensor_in_base_;
  std::vector<Match> matches_;
  std::vector<std::size_t> new_;  ///< sightings that start landmarks
  std::vector<PathPose> path_;
  SlamEstimate estimate_;
  std::int64_t next_id_ = -2, collapses_ = 0;
  std::optional<std::int64_t> last_detections_;
};

}  // namespace noctule::filters
