#pragma once
/// Core values with nothing left at its default and no list empty, within the limits of the messages. Made without
/// libm, so that their bits are the same on every machine.
#include <vector>

#include "core/contour.hpp"
#include "core/estimate.hpp"
#include "core/features.hpp"
#include "core/image.hpp"
#include "core/observations.hpp"
#include "core/rng.hpp"

namespace noctule::convert {

class RandomValues {
 public:
  explicit RandomValues(std::uint64_t seed) : rng_(seed, stream_id("convert")) {}

  Odometry odometry() { return {stamp(), pose(), covariance<3>()}; }

  UltrasonicScan ultrasonic_scan() {
    return {stamp(), number(0.01, 1.0), number(0.01, 0.1), number(1.0, 9.0), list<UltrasonicBeam>([this] {
              return UltrasonicBeam{pose(), number(0.0, 9.0), code(Echo::invalid)};
            })};
  }

  LandmarkDetections landmark_detections() {
    return {stamp(), pose(), list<LandmarkDetection>([this] {
              return LandmarkDetection{code(DetectionKind::range_only),
                                       number(0.0, 9.0),
                                       number(-3.0, 3.0),
                                       covariance<2>(),
                                       integer() - 1,
                                       number(0.0, 1.0)};
            })};
  }

  GroundTruth ground_truth() { return {stamp(), pose()}; }

  CameraImage camera_image() {
    CameraImage value{stamp(), {}};
    value.image.width = 2 + static_cast<int>(rng_.index(5));
    value.image.height = 2 + static_cast<int>(rng_.index(5));
    value.image.channels = rng_.index(2) == 0 ? 1 : 3;
    value.image.pixels.resize(static_cast<std::size_t>(value.image.width * value.image.height * value.image.channels));
    for (std::uint8_t& pixel : value.image.pixels) pixel = static_cast<std::uint8_t>(rng_.index(256));
    return value;
  }

  ContourFeatures contour_features() {
    return {stamp(), list<ContourFeature>([this] { return contour_feature(); })};
  }

  SlamEstimate slam_estimate() {
    return {stamp(), pose(),  covariance<3>(),    small(),          number(1.0, 100.0),
            small(), small(), rng_.index(2) == 1, number(0.1, 9.0), number(0.0, 9.0)};
  }

  PathEstimate path_estimate() {
    return {stamp(), list<PathPose>([this] { return PathPose{integer(), integer(), pose()}; })};
  }

  ParticleCloud particle_cloud() {
    return {stamp(), list<WeightedPose>([this] { return WeightedPose{pose(), number(0.0, 1.0)}; })};
  }

  LandmarkMap landmark_map() {
    return {stamp(), list<LandmarkEstimate>([this] {
              return LandmarkEstimate{integer(), code(LandmarkKind::undecided), vector3(), covariance<3>(), small()};
            })};
  }

  ContourMap contour_map() {
    return {stamp(), list<WallEstimate>([this] {
              return WallEstimate{wall(), covariance<2>(), number(-9.0, 0.0), number(0.0, 9.0), small(), small()};
            }),
            list<CylinderEstimate>([this] {
              return CylinderEstimate{cylinder(), covariance<3>(), number(0.0, 6.0), small(), small()};
            }),
            list<PointEstimate>([this] {
              return PointEstimate{vector2(), covariance<2>(), small(), small()};
            })};
  }

 private:
  double number(double low, double high) { return rng_.uniform(low, high); }
  std::int64_t integer() { return static_cast<std::int64_t>(rng_.index(1ull << 50)); }
  int small() { return static_cast<int>(1 + rng_.index(1000000)); }
  Stamp stamp() { return {integer(), integer()}; }
  Pose2 pose() { return {number(-9.0, 9.0), number(-9.0, 9.0), number(-3.0, 3.0)}; }
  Vector2 vector2() { return {number(-9.0, 9.0), number(-9.0, 9.0)}; }
  Vector3 vector3() { return {number(-9.0, 9.0), number(-9.0, 9.0), number(-9.0, 9.0)}; }
  Wall wall() { return {number(0.0, 9.0), number(-3.0, 3.0)}; }
  Cylinder cylinder() { return {vector2(), number(0.0, 2.0)}; }

  template <class Enum>
  Enum code(Enum last) {
    return static_cast<Enum>(rng_.index(static_cast<std::uint64_t>(last) + 1));
  }

  template <int N>
  Eigen::Matrix<double, N, N> covariance() {
    Eigen::Matrix<double, N, N> m;
    for (int i = 0; i < N; ++i) {
      m(i, i) = number(1.0, 2.0);
      for (int j = 0; j < i; ++j) m(i, j) = m(j, i) = number(-0.4, 0.4);
    }
    return m;
  }

  template <class Value, class Make>
  std::vector<Value> list(Make make) {
    std::vector<Value> values(1 + rng_.index(5));
    for (Value& value : values) value = make();
    return values;
  }

  ContourFeature contour_feature() {
    ContourFeature f;
    f.type = code(ContourType::ambiguous);
    f.track = integer();
    f.has_wall = rng_.index(2) == 1;
    f.wall = wall();
    f.wall_covariance = covariance<2>();
    f.wall_log_likelihood = number(-99.0, 0.0);
    f.has_circle = rng_.index(2) == 1;
    f.circle = cylinder();
    f.circle_covariance = covariance<3>();
    f.circle_log_likelihood = number(-99.0, 0.0);
    f.surface = vector2();
    f.stops = small();
    f.baseline = number(0.0, 9.0);
    f.readings = list<ReadingId>([this] { return ReadingId{integer(), small()}; });
    return f;
  }

  Rng rng_;
};

}  // namespace noctule::convert
