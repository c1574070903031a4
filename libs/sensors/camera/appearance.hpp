#pragma once
/// What a target in an image looks like: a histogram of its colours and a grid of histograms of its gradients, both of
/// any box of a frame at a cost that does not grow with the box.
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/image.hpp"
#include "core/image_box.hpp"
#include "core/parameters.hpp"

namespace noctule::sensors {

struct AppearanceParameters {
  double colour_sd = 0.2;
  double gradient_sd = 0.12;
  double context = 1.2;
  double learning = 0.04;
  double anchor = 0.5;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = AppearanceParameters;
    v.field("colour_sd", &P::colour_sd, unit::one, "sd of sqrt(1 - similarity) of colours where the target is",
            positive());
    v.field("gradient_sd", &P::gradient_sd, unit::one, "the same of gradients", positive());
    v.field("context", &P::context, unit::one, "side of the box whose gradients are compared, in sides of the target",
            between(1.0, 3.0));
    v.field("learning", &P::learning, unit::one, "share of a frame in the appearance that follows the target",
            between(0.0, 1.0));
    v.field("anchor", &P::anchor, unit::one, "share of the first frame that never fades", between(0.0, 1.0));
  }
};

/// Both in [0, 1], 1 for identical patches.
struct Similarity {
  double colour = 0.0;    ///< Bhattacharyya coefficient of the histograms
  double gradient = 0.0;  ///< correlation of the grids of gradients; 0 where it is negative
  /// Geometric mean.
  [[nodiscard]] double joint() const;
};

/// Colours by hue and saturation (8 x 8) or, where there is next to none, by value (8); of a grey image grey levels
/// relative to mean and sd of the box (16). Weighted by Epanechnikov's kernel.
inline constexpr std::size_t kColourBins = 72;
using ColourHistogram = std::array<float, kColourBins>;  ///< sum 1, or 0 of a flat grey box

/// Histograms of 8 directions of gradients (without sign) in 6 x 6 cells, each relative to the strength of its
/// neighbourhood, as differences from the direction's mean; norm 1 (0 of a flat box). Cells at the rim count less.
inline constexpr int kGridCells = 6;
inline constexpr int kDirections = 8;
using GradientGrid = std::array<float, static_cast<std::size_t>(kGridCells* kGridCells* kDirections)>;

/// A frame prepared for looking at many boxes.
class FrameFeatures {
 public:
  /// \param target_size [pixels]; large targets are looked at in a shrunk image
  explicit FrameFeatures(const Vector2& target_size);
  ~FrameFeatures();
  FrameFeatures(FrameFeatures&&) noexcept;
  FrameFeatures& operator=(FrameFeatures&&) noexcept;

  /// \param image consistent; must live as long as histograms are asked for
  void update(const Image& image);

  void histogram(const ImageBox& box, ColourHistogram& histogram) const;
  void gradients(const ImageBox& box, GradientGrid& grid) const;

 private:
  struct Scratch;
  void integrate();

  int shrink_;
  int width_ = 0, height_ = 0;  ///< of the shrunk image
  const Image* image_ = nullptr;
  std::unique_ptr<Scratch> scratch_;
  std::vector<std::uint32_t> integral_;  ///< (width + 1) x (height + 1) x kDirections
};

/// A target's appearance: that of the first frame, mixed with one that follows it.
class Appearance {
 public:
  Appearance(const AppearanceParameters& parameters, const FrameFeatures& frame, const ImageBox& target);

  [[nodiscard]] Similarity compare(const FrameFeatures& frame, const ImageBox& box) const;
  /// Up to a constant; finite.
  [[nodiscard]] double log_likelihood(const Similarity& similarity) const;
  /// Lets the appearance follow what is in the box.
  void adapt(const FrameFeatures& frame, const ImageBox& box);

 private:
  void blend();
  [[nodiscard]] ImageBox with_context(const ImageBox& box) const;

  AppearanceParameters parameters_;
  ColourHistogram first_colours_{}, later_colours_{}, colours_{};
  GradientGrid first_grid_{}, later_grid_{}, grid_{};
};

}  // namespace noctule::sensors
