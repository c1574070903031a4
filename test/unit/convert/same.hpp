#pragma once
/// Core values field by field: equality to the bit, and a visit to every number.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <vector>

#include "core/contour.hpp"
#include "core/estimate.hpp"
#include "core/features.hpp"
#include "core/image.hpp"
#include "core/observations.hpp"

namespace noctule::convert {

// Structured bindings name every field: one that is added to a core value does not compile here until it is compared.
#define NOCTULE_FIELDS(Type, ...)     \
  inline auto fields(const Type& v) { \
    const auto& [__VA_ARGS__] = v;    \
    return std::tie(__VA_ARGS__);     \
  }                                   \
  inline auto fields(Type& v) {       \
    auto& [__VA_ARGS__] = v;          \
    return std::tie(__VA_ARGS__);     \
  }
NOCTULE_FIELDS(Stamp, a, b)
NOCTULE_FIELDS(Pose2, a, b, c)
NOCTULE_FIELDS(Odometry, a, b, c)
NOCTULE_FIELDS(UltrasonicBeam, a, b, c)
NOCTULE_FIELDS(UltrasonicScan, a, b, c, d, e)
NOCTULE_FIELDS(LandmarkDetection, a, b, c, d, e, f)
NOCTULE_FIELDS(LandmarkDetections, a, b, c)
NOCTULE_FIELDS(GroundTruth, a, b)
NOCTULE_FIELDS(Image, a, b, c, d)
NOCTULE_FIELDS(CameraImage, a, b)
NOCTULE_FIELDS(ReadingId, a, b)
NOCTULE_FIELDS(Wall, a, b)
NOCTULE_FIELDS(Cylinder, a, b)
NOCTULE_FIELDS(ContourFeature, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
NOCTULE_FIELDS(ContourFeatures, a, b)
NOCTULE_FIELDS(SlamEstimate, a, b, c, d, e, f, g, h, i, j)
NOCTULE_FIELDS(PathPose, a, b, c)
NOCTULE_FIELDS(PathEstimate, a, b)
NOCTULE_FIELDS(WeightedPose, a, b)
NOCTULE_FIELDS(ParticleCloud, a, b)
NOCTULE_FIELDS(LandmarkEstimate, a, b, c, d, e)
NOCTULE_FIELDS(LandmarkMap, a, b)
NOCTULE_FIELDS(WallEstimate, a, b, c, d, e, f)
NOCTULE_FIELDS(CylinderEstimate, a, b, c, d, e)
NOCTULE_FIELDS(PointEstimate, a, b, c, d)
NOCTULE_FIELDS(ContourMap, a, b, c, d)
#undef NOCTULE_FIELDS

template <class T>
bool same(const T& a, const T& b);
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const T& x, const T& y) { return same(x, y); });
}
template <int R, int C>
bool same(const Eigen::Matrix<double, R, C>& a, const Eigen::Matrix<double, R, C>& b) {
  return std::equal(a.data(), a.data() + R * C, b.data(), [](double x, double y) { return same(x, y); });
}

template <class T>
bool same(const T& a, const T& b) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    return a == b;
  } else {
    return std::apply(
        [&](const auto&... x) { return std::apply([&](const auto&... y) { return (same(x, y) && ...); }, fields(b)); },
        fields(a));
  }
}

/// Calls `visit` with a reference to each double in the value.
template <class T, class Visit>
void for_each_double(T& value, Visit visit) {
  if constexpr (std::is_same_v<T, double>) {
    visit(value);
  } else if constexpr (requires { value.data(); }) {  // a list or a matrix
    for (std::size_t i = 0; i < static_cast<std::size_t>(value.size()); ++i) for_each_double(value.data()[i], visit);
  } else if constexpr (!std::is_arithmetic_v<T> && !std::is_enum_v<T>) {
    std::apply([&](auto&... field) { (for_each_double(field, visit), ...); }, fields(value));
  }
}

}  // namespace noctule::convert
