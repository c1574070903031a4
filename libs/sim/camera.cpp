#include "sim/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/rng.hpp"

namespace noctule::sim {
namespace {

constexpr std::uint64_t kNoise = stream_id("camera.noise");
constexpr int kMostExposures = 16;  // drawn for one blurred picture
constexpr int kNormals = 4096;      // of a table, told apart by 12 bits

/// Middles of 4096 equally likely parts of the standard normal distribution, scaled to a variance of exactly 1.
std::array<float, kNormals> make_normals() {
  std::array<double, kNormals> x{};
  double z = -3.7, sum = 0.0;
  for (int i = 0; i < kNormals; ++i) {
    const double p = (i + 0.5) / kNormals;
    for (int step = 0; step < 30; ++step) {  // Newton, from the neighbour below
      const double error = 0.5 * std::erfc(-z / std::sqrt(2.0)) - p;
      const double next = z - error * std::sqrt(kTwoPi) * std::exp(0.5 * z * z);
      if (std::abs(next - z) < 1e-12) break;
      z = next;
    }
    x[static_cast<std::size_t>(i)] = z;
    sum += z * z;
  }
  std::array<float, kNormals> normals{};
  const double scale = std::sqrt(kNormals / sum);
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = static_cast<float>(scale * x[i]);
  return normals;
}

/// Half of a Gaussian, from its middle; the whole sums to 1.
std::vector<float> gaussian_kernel(double sd) {
  std::vector<double> half{1.0};
  for (int i = 1; i <= static_cast<int>(std::ceil(3.0 * sd)); ++i) half.push_back(std::exp(-0.5 * i * i / (sd * sd)));
  double sum = -half.front();
  for (const double h : half) sum += 2.0 * h;
  std::vector<float> kernel;
  for (const double h : half) kernel.push_back(static_cast<float>(h / sum));
  return kernel;
}

/// Blurs along lines of `count` values that are `stride` apart.
void blur_line(const float* from, float* to, int count, int stride, const std::vector<float>& kernel) {
  const int reach = static_cast<int>(kernel.size()) - 1;
  const auto at = [&](int i) { return from[std::clamp(i, 0, count - 1) * stride]; };
  for (int i = 0; i < count; ++i) {
    float sum = kernel[0] * from[i * stride];
    for (int k = 1; k <= reach; ++k) sum += kernel[static_cast<std::size_t>(k)] * (at(i - k) + at(i + k));
    to[i * stride] = sum;
  }
}

}  // namespace

Camera::Camera(const CameraParameters& parameters, const RoomParameters& room, std::uint64_t seed)
    : parameters_(parameters),
      seed_(seed),
      channels_(parameters.colour ? 3 : 1),
      renderer_(room, parameters.intrinsics, parameters.mounting, channels_),
      kernel_(gaussian_kernel(parameters.blur)) {
  const auto& c = parameters.intrinsics;
  light_.resize(static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height) *
                static_cast<std::size_t>(channels_));
  blurred_.resize(light_.size());
}

CameraImage Camera::shoot(const Pose2& begin, const Pose2& end, std::int64_t seq, double time) {
  expose(begin, end);
  if (kernel_.size() > 1) defocus();
  return {{0, seq}, develop(seq, time)};
}

void Camera::expose(const Pose2& begin, const Pose2& end) {
  std::ranges::fill(light_, 0.0f);
  const Pose2 way = between(begin, end);
  // One picture for each pixel that something half a metre away moves by.
  const double moved = parameters_.intrinsics.fx * (std::abs(way.yaw) + way.position().norm() / 0.5);
  const int n = std::clamp(static_cast<int>(std::ceil(moved)), 1, kMostExposures);
  for (int i = 0; i < n; ++i) {
    const double f = (i + 0.5) / n;
    renderer_.add_light(begin * Pose2{f * way.x, f * way.y, f * way.yaw}, 1.0f / static_cast<float>(n), light_);
  }
}

void Camera::defocus() {
  const int width = parameters_.intrinsics.width, height = parameters_.intrinsics.height;
  const int row = width * channels_;
  for (int y = 0; y < height; ++y) {
    for (int c = 0; c < channels_; ++c) {
      blur_line(&light_[static_cast<std::size_t>(y * row + c)], &blurred_[static_cast<std::size_t>(y * row + c)], width,
                channels_, kernel_);
    }
  }
  const int reach = static_cast<int>(kernel_.size()) - 1;
  for (int y = 0; y < height; ++y) {
    float* out = &light_[static_cast<std::size_t>(y * row)];
    std::fill(out, out + row, 0.0f);
    for (int k = -reach; k <= reach; ++k) {
      const float weight = kernel_[static_cast<std::size_t>(std::abs(k))];
      const float* in = &blurred_[static_cast<std::size_t>(std::clamp(y + k, 0, height - 1) * row)];
      for (int i = 0; i < row; ++i) out[i] += weight * in[i];
    }
  }
}

Image Camera::develop(std::int64_t seq, double time) const {
  static const std::array<float, kNormals> normals = make_normals();
  const int width = parameters_.intrinsics.width, height = parameters_.intrinsics.height;
  const LightingParameters& l = parameters_.lighting;
  const double gain = l.gain * (1.0 + l.swing * std::sin(kTwoPi * time / l.period));
  std::vector<float> gains;
  for (int x = 0; x < width; ++x) {
    const double across = 2.0 * (x + 0.5) / width - 1.0;
    gains.insert(gains.end(), static_cast<std::size_t>(channels_),
                 static_cast<float>(gain * (1.0 + l.gradient * across)));
  }
  Image image{width, height, channels_, std::vector<std::uint8_t>(light_.size())};
  const float sd = static_cast<float>(parameters_.noise);
  for (int y = 0; y < height; ++y) {
    Rng rng(seed_, kNoise, static_cast<std::uint64_t>(seq), static_cast<std::uint32_t>(y));
    const std::size_t begin = static_cast<std::size_t>(y) * gains.size();
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < gains.size(); ++i) {
      bits = i % 5 == 0 ? rng() : bits >> 12;
      const float value = gains[i] * light_[begin + i] + sd * normals[bits & (kNormals - 1)];
      image.pixels[begin + i] = static_cast<std::uint8_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
    }
  }
  return image;
}

}  // namespace noctule::sim
