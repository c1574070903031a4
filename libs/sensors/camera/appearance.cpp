#include "sensors/camera/appearance.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/angles.hpp"
#include "sensors/camera/grey_image.hpp"

namespace noctule::sensors {
namespace {

constexpr int kSamples = 12;         // along each side of a box, for its colours
constexpr double kLeastSide = 48.0;  // of the target in the shrunk image [pixels]
constexpr float kRim = 0.6f;
constexpr int kGreyBins = 16;
constexpr int kReach = 255;             // of a difference of neighbours
constexpr float kNoiseStrength = 3.0f;  // [grey levels]: weaker gradients are not blown up

/// Weights of the samples, sum 1: Epanechnikov's kernel inscribed in the box.
const std::array<float, kSamples * kSamples>& kernel() {
  static const auto weights = [] {
    std::array<float, kSamples * kSamples> w{};
    float sum = 0.0f;
    for (int i = 0; i < kSamples * kSamples; ++i) {
      const double u = (i % kSamples + 0.5) / kSamples * 2.0 - 1.0, v = (i / kSamples + 0.5) / kSamples * 2.0 - 1.0;
      w[static_cast<std::size_t>(i)] = static_cast<float>(std::max(0.0, 1.0 - u * u - v * v));
      sum += w[static_cast<std::size_t>(i)];
    }
    for (float& v : w) v /= sum;
    return w;
  }();
  return weights;
}

/// Bin of a colour, five bits a channel (blue, green, red).
const std::vector<std::uint8_t>& colour_bins() {
  static const auto bins = [] {
    std::vector<std::uint8_t> table(1u << 15);
    for (std::size_t i = 0; i < table.size(); ++i) {
      const auto level = [&](unsigned shift) { return (static_cast<double>((i >> shift) & 31u) + 0.5) / 32.0; };
      const double b = level(0), g = level(5), r = level(10);
      const double most = std::max({b, g, r}), chroma = most - std::min({b, g, r});
      if (chroma < 0.1 * most || most < 0.1) {
        table[i] = static_cast<std::uint8_t>(64 + std::min(7, static_cast<int>(8.0 * most)));
        continue;
      }
      double hue = most == r ? (g - b) / chroma : most == g ? 2.0 + (b - r) / chroma : 4.0 + (r - g) / chroma;
      if (hue < 0.0) hue += 6.0;
      const int h = static_cast<int>(8.0 * hue / 6.0) % 8;
      const int s = std::min(7, static_cast<int>(8.0 * chroma / most));
      table[i] = static_cast<std::uint8_t>(8 * h + s);
    }
    return table;
  }();
  return bins;
}

/// A gradient shared out between two neighbouring directions.
struct Shares {
  std::uint8_t first, second;
  std::uint16_t to_first, to_second;
};

/// Of every pair of differences, scaled by 4 and, as strong edges must not drown the others, by the square root.
const std::vector<Shares>& gradient_shares() {
  static const auto shares = [] {
    constexpr int kSide = 2 * kReach + 1;
    std::vector<Shares> table(static_cast<std::size_t>(kSide) * kSide);
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const double strength = 16.0 * std::sqrt(std::hypot(dx, dy));
        double at = std::atan2(dy, dx) / kPi * kDirections - 0.5;
        if (at < 0.0) at += kDirections;
        if (at < 0.0) at += kDirections;
        const int low = static_cast<int>(std::floor(at));
        const double part = at - low;
        table[static_cast<std::size_t>((dy + kReach) * kSide + dx + kReach)] = {
            static_cast<std::uint8_t>(low % kDirections), static_cast<std::uint8_t>((low + 1) % kDirections),
            static_cast<std::uint16_t>(std::lround(strength * (1.0 - part))),
            static_cast<std::uint16_t>(std::lround(strength * part))};
      }
    }
    return table;
  }();
  return shares;
}

template <class Values>
auto as_array(Values& values) {
  using Number = std::remove_reference_t<decltype(values[0])>;
  using Array = Eigen::Array<float, Eigen::Dynamic, 1>;
  return Eigen::Map<std::conditional_t<std::is_const_v<Number>, const Array, Array>>(
      values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Cells at the rim see more of what is behind the target.
float taper(int cell) {
  return cell == 0 || cell == kGridCells - 1 ? kRim : 1.0f;
}

/// Mean 0 of each direction, then the rim made weaker, norm 1; all 0 when there is nothing to speak of.
void standardise(GradientGrid& grid) {
  Eigen::Map<Eigen::Array<float, kDirections, kGridCells * kGridCells>> cells(grid.data());
  const Eigen::Array<float, kDirections, 1> means = cells.rowwise().mean();
  for (int i = 0; i < kGridCells * kGridCells; ++i)
    cells.col(i) = (cells.col(i) - means) * (taper(i / kGridCells) * taper(i % kGridCells));
  auto values = as_array(grid);
  const float norm = values.matrix().norm();
  if (norm > 1e-3f) {
    values /= norm;
  } else {
    values.setZero();
  }
}

}  // namespace

double Similarity::joint() const {
  return std::sqrt(colour * gradient);
}

struct FrameFeatures::Scratch {
  cv::Mat full, grey;
};

FrameFeatures::FrameFeatures(const Vector2& target_size)
    : shrink_(std::max(1, static_cast<int>(target_size.minCoeff() / kLeastSide))),
      scratch_(std::make_unique<Scratch>()) {}
FrameFeatures::~FrameFeatures() = default;
FrameFeatures::FrameFeatures(FrameFeatures&&) noexcept = default;
FrameFeatures& FrameFeatures::operator=(FrameFeatures&&) noexcept = default;

void FrameFeatures::update(const Image& image) {
  image_ = &image;
  grey_image(image, std::min({shrink_, image.width, image.height}), scratch_->full, scratch_->grey);
  width_ = scratch_->grey.cols;
  height_ = scratch_->grey.rows;
  integral_.resize(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1) * kDirections);
  integrate();
}

void FrameFeatures::integrate() {
  const auto& shares = gradient_shares();
  const auto line = static_cast<std::size_t>(width_ + 1) * kDirections;
  std::fill_n(integral_.begin(), line, 0u);
  for (int v = 0; v < height_; ++v) {
    const std::uint8_t* const row = scratch_->grey.ptr<std::uint8_t>(v);
    const std::uint8_t* const above = scratch_->grey.ptr<std::uint8_t>(std::max(v - 1, 0));
    const std::uint8_t* const below = scratch_->grey.ptr<std::uint8_t>(std::min(v + 1, height_ - 1));
    const std::uint32_t* before = integral_.data() + static_cast<std::size_t>(v) * line;
    std::uint32_t* now = integral_.data() + static_cast<std::size_t>(v + 1) * line;
    std::fill_n(now, kDirections, 0u);
    std::array<std::uint32_t, kDirections> sums{};
    for (int u = 0; u < width_; ++u) {
      const int dx = row[std::min(u + 1, width_ - 1)] - row[std::max(u - 1, 0)], dy = below[u] - above[u];
      const Shares& s = shares[static_cast<std::size_t>((dy + kReach) * (2 * kReach + 1) + dx + kReach)];
      sums[s.first] += s.to_first;
      sums[s.second] += s.to_second;
      before += kDirections;
      now += kDirections;
      for (std::size_t k = 0; k < kDirections; ++k) now[k] = before[k] + sums[k];
    }
  }
}

void FrameFeatures::histogram(const ImageBox& box, ColourHistogram& histogram) const {
  histogram.fill(0.0f);
  std::array<std::size_t, kSamples> columns{}, lines{};
  const auto place = [](double at, int most) { return static_cast<std::size_t>(std::clamp(at, 0.0, most - 1.0)); };
  const auto channels = static_cast<std::size_t>(image_->channels);
  for (int i = 0; i < kSamples; ++i) {
    const double part = (i + 0.5) / kSamples - 0.5;
    const auto k = static_cast<std::size_t>(i);
    columns[k] = place(box.centre.x() + part * box.size.x() + 0.5, image_->width) * channels;
    lines[k] = place(box.centre.y() + part * box.size.y() + 0.5, image_->height) *
               static_cast<std::size_t>(image_->width) * channels;
  }
  const auto& weights = kernel();
  const std::uint8_t* const pixels = image_->pixels.data();
  std::size_t i = 0;
  if (channels == 3) {
    const auto& bins = colour_bins();
    for (const std::size_t line : lines) {
      for (const std::size_t column : columns) {
        const std::uint8_t* const c = pixels + line + column;
        histogram[bins[static_cast<std::size_t>((c[0] >> 3) | (c[1] >> 3) << 5 | (c[2] >> 3) << 10)]] += weights[i++];
      }
    }
    return;
  }
  std::array<float, kSamples * kSamples> levels{};
  float mean = 0.0f, square = 0.0f;
  for (const std::size_t line : lines) {
    for (const std::size_t column : columns) {
      const float level = pixels[line + column];
      levels[i] = level;
      mean += weights[i] * level;
      square += weights[i] * level * level;
      ++i;
    }
  }
  const float variance = square - mean * mean;
  if (!(variance > 0.25f)) return;                               // flat
  const float scale = kGreyBins / (5.0f * std::sqrt(variance));  // bins over 2.5 sd to both sides
  for (i = 0; i < levels.size(); ++i) {
    const float at = std::clamp((levels[i] - mean) * scale + 0.5f * kGreyBins - 0.5f, 0.0f, kGreyBins - 1.001f);
    const auto low = static_cast<std::size_t>(at);
    const float part = at - static_cast<float>(low);
    histogram[low] += weights[i] * (1.0f - part);
    histogram[low + 1] += weights[i] * part;
  }
}

void FrameFeatures::gradients(const ImageBox& box, GradientGrid& grid) const {
  using Cell = Eigen::Array<std::uint32_t, kDirections, 1>;
  using Histogram = Eigen::Array<float, kDirections, 1>;
  std::array<int, kGridCells + 1> columns{}, lines{};
  for (int i = 0; i <= kGridCells; ++i) {
    const double part = static_cast<double>(i) / kGridCells - 0.5;
    const double u = (box.centre.x() + part * box.size.x() + 0.5) / shrink_;
    const double v = (box.centre.y() + part * box.size.y() + 0.5) / shrink_;
    columns[static_cast<std::size_t>(i)] = static_cast<int>(std::clamp(u, 0.0, static_cast<double>(width_)) + 0.5);
    lines[static_cast<std::size_t>(i)] = static_cast<int>(std::clamp(v, 0.0, static_cast<double>(height_)) + 0.5);
  }
  const auto at = [&](std::size_t line, std::size_t column) {
    const auto index = static_cast<std::size_t>(lines[line]) * static_cast<std::size_t>(width_ + 1) +
                       static_cast<std::size_t>(columns[column]);
    return Eigen::Map<const Cell>(integral_.data() + index * kDirections);
  };
  std::array<float, static_cast<std::size_t>((kGridCells + 2) * (kGridCells + 2))> energy{};  // with a rim of 0
  for (std::size_t r = 0; r < kGridCells; ++r) {
    for (std::size_t c = 0; c < kGridCells; ++c) {
      const float area = static_cast<float>((lines[r + 1] - lines[r]) * (columns[c + 1] - columns[c]));
      Eigen::Map<Histogram> cell(grid.data() + (r * kGridCells + c) * kDirections);
      const Cell sum = at(r + 1, c + 1) - at(r + 1, c) - at(r, c + 1) + at(r, c);
      cell = area > 0.0f ? Histogram(sum.cast<std::int32_t>().cast<float>() * (0.0625f / area))
                         : Histogram(Histogram::Zero());
      energy[(r + 1) * (kGridCells + 2) + c + 1] = cell.matrix().squaredNorm();
    }
  }
  constexpr float kFloor = 9.0f * kNoiseStrength / kDirections;
  for (std::size_t r = 0; r < kGridCells; ++r) {
    for (std::size_t c = 0; c < kGridCells; ++c) {
      float around = kFloor;
      for (std::size_t k = 0; k < 9; ++k) around += energy[(r + k / 3) * (kGridCells + 2) + c + k % 3];
      Eigen::Map<Histogram>(grid.data() + (r * kGridCells + c) * kDirections) /= std::sqrt(around);
    }
  }
  standardise(grid);
}

Appearance::Appearance(const AppearanceParameters& parameters, const FrameFeatures& frame, const ImageBox& target)
    : parameters_(parameters) {
  frame.histogram(target, first_colours_);
  frame.gradients(with_context(target), first_grid_);
  later_colours_ = first_colours_;
  later_grid_ = first_grid_;
  blend();
}

ImageBox Appearance::with_context(const ImageBox& box) const {
  return {box.centre, parameters_.context * box.size};
}

Similarity Appearance::compare(const FrameFeatures& frame, const ImageBox& box) const {
  ColourHistogram colours;
  GradientGrid grid;
  frame.histogram(box, colours);
  frame.gradients(with_context(box), grid);
  const float common = (as_array(colours) * as_array(colours_)).sqrt().sum();
  const float correlation = as_array(grid).matrix().dot(as_array(grid_).matrix());
  return {std::clamp(static_cast<double>(common), 0.0, 1.0), std::clamp(static_cast<double>(correlation), 0.0, 1.0)};
}

double Appearance::log_likelihood(const Similarity& s) const {
  return -0.5 * ((1.0 - s.colour) / (parameters_.colour_sd * parameters_.colour_sd) +
                 (1.0 - s.gradient) / (parameters_.gradient_sd * parameters_.gradient_sd));
}

void Appearance::adapt(const FrameFeatures& frame, const ImageBox& box) {
  ColourHistogram colours;
  GradientGrid grid;
  frame.histogram(box, colours);
  frame.gradients(with_context(box), grid);
  const auto share = static_cast<float>(parameters_.learning);
  as_array(later_colours_) += share * (as_array(colours) - as_array(later_colours_));
  as_array(later_grid_) += share * (as_array(grid) - as_array(later_grid_));
  blend();
}

void Appearance::blend() {
  const auto first = static_cast<float>(parameters_.anchor);
  as_array(colours_) = first * as_array(first_colours_) + (1.0f - first) * as_array(later_colours_);
  as_array(grid_) = first * as_array(first_grid_) + (1.0f - first) * as_array(later_grid_);
  const float norm = as_array(grid_).matrix().norm();
  if (norm > 0.0f) as_array(grid_) /= norm;
}

}  // namespace noctule::sensors
