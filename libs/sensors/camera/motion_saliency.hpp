#pragma once
/// Where an image moves by itself: differences of successive frames after the motion of the camera is taken out, as a
/// distribution over the image from which a tracker draws where to look.
#include <cstddef>
#include <memory>
#include <vector>

#include "core/image.hpp"
#include "core/parameters.hpp"
#include "core/pose2.hpp"
#include "core/rng.hpp"
#include "particle/alias_table.hpp"

namespace noctule::sensors {

/// How the frame before is laid over the present one.
enum class EgoMotion : std::int8_t {
  none,
  similarity,  ///< shift, rotation, scale
  homography   ///< a turning camera, or a plane
};

struct MotionSaliencyParameters {
  EgoMotion ego_motion = EgoMotion::homography;
  double blur = 2.0;             ///< [pixels] sd
  double least_difference = 12;  ///< [grey levels]
  double deviations = 2.5;       ///< differences count above mean + this many sd of their image
  double cell = 8.0;             ///< [pixels]
  double uniform_share = 0.05;
  int corners = 150;
  double least_inliers = 0.4;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = MotionSaliencyParameters;
    v.choice("ego_motion", &P::ego_motion,
             {{"homography", EgoMotion::homography}, {"similarity", EgoMotion::similarity}, {"none", EgoMotion::none}},
             "what the camera's own motion is taken for");
    v.field("blur", &P::blur, unit::one, "sd of the blur before differences, in pixels", between(0.5, 20.0));
    v.field("least_difference", &P::least_difference, unit::one, "differences below are noise, in grey levels",
            between(0, 255));
    v.field("deviations", &P::deviations, unit::one, "and so are those below mean + this many sd", at_least(0.0));
    v.field("cell", &P::cell, unit::one, "side of a cell of the distribution in pixels", between(2, 256));
    v.field("uniform_share", &P::uniform_share, unit::one, "of the distribution, where nothing moves too",
            Range{.min = 0.0, .max = 1.0, .min_allowed = false});
    v.field("corners", &P::corners, unit::one, "greatest number of corners followed", between(8, 2000));
    v.field("least_inliers", &P::least_inliers, unit::one,
            "share of the corners that must agree on a motion of the camera, else none is taken out",
            between(0.0, 1.0));
  }
};

/// MSM = |I_k - I_(k-1)| (000_e1bb8f050daf9968, eq. 8) of blurred grey images, I_(k-1) moved as the camera moved. Works
/// on an image shrunk to at most 320 columns. An object that stands still has no motion saliency.
class MotionSaliency {
 public:
  /// \throws InputError for parameters outside their ranges
  explicit MotionSaliency(const MotionSaliencyParameters& parameters);
  ~MotionSaliency();
  MotionSaliency(MotionSaliency&&) noexcept;
  MotionSaliency& operator=(MotionSaliency&&) noexcept;

  /// Takes the next frame. After the first one, and wherever nothing moves, the distribution is uniform.
  /// \throws InputError for an inconsistent image or one of another size than those before
  void update(const Image& image);

  /// Prepares draw() and log_density() for boxes about as large as this: centres are drawn where such a box holds
  /// much motion. \param size [pixels] of the target \param uniform_share instead of the parameters', where it is
  /// larger
  void prepare(const Vector2& size, double uniform_share = 0.0);
  /// A place with the density of log_density().
  [[nodiscard]] Vector2 draw(Rng& rng) const;
  /// Of a place [1/pixels^2]; -inf outside of the image. Finite everywhere inside.
  [[nodiscard]] double log_density(const Vector2& place) const;

  [[nodiscard]] double log_uniform_density() const;

  /// Saliency summed over each cell, row by row; grey levels x pixels of the image worked on.
  [[nodiscard]] const std::vector<double>& cells() const { return cells_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Whether a motion of the camera was found and taken out.
  [[nodiscard]] bool compensated() const { return compensated_; }
  /// Share of pixels that count as moving.
  [[nodiscard]] double moving_share() const { return moving_share_; }

 private:
  struct Frames;
  [[nodiscard]] std::size_t cell_at(int column, int row) const;
  [[nodiscard]] Vector2 cell_size(std::size_t cell) const;

  MotionSaliencyParameters parameters_;
  std::unique_ptr<Frames> frames_;
  int width_ = 0, height_ = 0, columns_ = 0, rows_ = 0;
  bool compensated_ = false;
  double moving_share_ = 0.0;
  std::vector<double> cells_, sums_, pooled_;
  particle::AliasTable table_;
};

}  // namespace noctule::sensors
