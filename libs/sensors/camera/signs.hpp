#pragma once
/// Flat textured signs from a catalogue of pictures.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/parameters.hpp"
#include "sensors/camera/landmark_detector.hpp"

namespace noctule::sensors {

/// One sign of the catalogue. Its height follows from the picture.
struct SignParameters {
  std::int64_t id = 0;
  std::filesystem::path picture;  ///< empty: models::sign_pattern(pattern)
  std::uint64_t pattern = 0;
  double width = 0.40;  ///< [m]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SignParameters;
    v.field("id", &P::id, unit::one, "identity as a landmark", at_least(0));
    v.field("picture", &P::picture, "its picture; absent: the generated sign");
    v.field("pattern", &P::pattern, unit::one, "number of the generated sign");
    v.field("width_cm", &P::width, unit::centimetre, "width of the sign", positive());
  }
};

struct SignDetectorParameters {
  std::vector<SignParameters> catalogue;
  int features = 600;            ///< of a picture, at most
  int fast_threshold = 20;       ///< contrast of a corner [grey levels]
  double ratio = 0.85;           ///< of the distances of the best and the second best descriptor
  int min_inliers = 8;           ///< matches that agree on one view
  double inlier_px = 3.0;        ///< largest distance of such a match
  double min_side_px = 20.0;     ///< smaller pictures of a sign are left out
  double min_correlation = 0.8;  ///< of the sign's picture with the image

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SignDetectorParameters;
    v.list("catalogue", &P::catalogue, "signs that can be met");
    v.field("features", &P::features, unit::one, "features of an image at most", between(50, 5000));
    v.field("fast_threshold", &P::fast_threshold, unit::one, "contrast of a feature in grey levels", between(2, 100));
    v.field("ratio", &P::ratio, unit::one, "largest ratio of the distances to the best and second best descriptor",
            between(0.3, 1.0));
    v.field("min_inliers", &P::min_inliers, unit::one, "fewest matches that agree on one view", at_least(5));
    v.field("inlier_px", &P::inlier_px, unit::one, "largest distance of such a match in pixels", positive());
    v.field("min_side_px", &P::min_side_px, unit::one, "smaller pictures of a sign are left out", at_least(8.0));
    v.field("min_correlation", &P::min_correlation, unit::one,
            "least correlation of the sign's picture with the image, once aligned", between(0.0, 1.0));
  }
  [[nodiscard]] std::string validate() const;
};

/// Reads a picture file; given by whoever may read files.
using PictureReader = std::function<Image(const std::filesystem::path&)>;

/// Signs found by features and a homography, then aligned with the image pixel by pixel (planar_alignment.hpp). The
/// landmark is the middle of the sign.
/// \throws InputError on a parameter out of its range, or a picture that cannot be used
[[nodiscard]] std::unique_ptr<LandmarkDetector> make_sign_detector(const SignDetectorParameters& parameters,
                                                                   const models::CameraIntrinsics& camera,
                                                                   const models::CameraMounting& mounting,
                                                                   const PictureReader& read_picture = {});

}  // namespace noctule::sensors
