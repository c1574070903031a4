#pragma once
/// Small films of a textured disc before a textured background, with known truth: what makes a tracker lose its target,
/// one thing a film.
#include <cstdint>
#include <vector>

#include "core/image.hpp"
#include "core/image_box.hpp"
#include "core/parameters.hpp"

namespace noctule::sim {

enum class TargetFilm : std::int8_t {
  smooth,       ///< along a slow Lissajous figure
  oscillation,  ///< to and fro, up to 25 pixels a frame
  teleport,     ///< as smooth, and 150 pixels to the side every 60 frames
  occlusion,    ///< 15 frames fully behind a bar, time and again
  pan,          ///< as smooth in the image, and the camera turns by 3 pixels a frame
  distractor,   ///< as smooth, and a disc of much the same colour moves about
  lighting,     ///< as smooth, grows and shrinks, and the light goes down to 40 % for a while
  still         ///< does not move
};

struct TargetFilmParameters {
  TargetFilm film = TargetFilm::smooth;
  int width = 320;   ///< [pixels]
  int height = 240;  ///< [pixels]
  int frames = 150;
  double radius = 16.0;   ///< of the disc [pixels]
  double noise_sd = 3.0;  ///< [grey levels] of each pixel and colour
  bool grey = false;

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = TargetFilmParameters;
    v.choice("film", &P::film,
             {{"smooth", TargetFilm::smooth},
              {"oscillation", TargetFilm::oscillation},
              {"teleport", TargetFilm::teleport},
              {"occlusion", TargetFilm::occlusion},
              {"pan", TargetFilm::pan},
              {"distractor", TargetFilm::distractor},
              {"lighting", TargetFilm::lighting},
              {"still", TargetFilm::still}},
             "what happens");
    v.field("width", &P::width, unit::one, "width of the images in pixels", between(320, 4096));
    v.field("height", &P::height, unit::one, "height of the images in pixels", between(240, 4096));
    v.field("frames", &P::frames, unit::one, "number of images", between(2, 100000));
    v.field("radius", &P::radius, unit::one, "radius of the target in pixels", between(6, 40));
    v.field("noise_sd", &P::noise_sd, unit::one, "sd of a pixel's noise in grey levels", between(0, 64));
    v.field("grey", &P::grey, unit::one, "true: images without colours");
  }
};

/// A film: the same for the same seed, whichever frame is asked for first.
class TargetScene {
 public:
  /// \throws InputError for parameters outside their ranges
  TargetScene(const TargetFilmParameters& parameters, std::uint64_t seed);

  [[nodiscard]] int frames() const { return parameters_.frames; }
  [[nodiscard]] Image frame(int k) const;
  /// Where the target is, hidden or not.
  [[nodiscard]] ImageBox truth(int k) const;
  /// Share of the target's height that is not behind the bar, 1 where there is none.
  [[nodiscard]] double visible(int k) const;
  /// Frames from which on the target is somewhere else, or seen again after it was hidden.
  [[nodiscard]] std::vector<int> losses() const;

 private:
  struct Disc {
    Vector2 centre;
    double radius;
    double hue;
    std::uint64_t texture;
  };
  [[nodiscard]] Vector2 lissajous(int k, std::uint32_t slot, const Vector2& amplitude) const;
  void paint_background();
  void paint(const Disc& disc, Image& image) const;
  void paint_bar(Image& image) const;
  void expose(int k, Image& image) const;
  [[nodiscard]] int pan(int k) const;

  TargetFilmParameters parameters_;
  std::uint64_t seed_;
  double hue_;  ///< of the target, in [0, 6)
  Image background_;
  std::vector<float> noise_;  ///< a pool of normal numbers
};

}  // namespace noctule::sim
