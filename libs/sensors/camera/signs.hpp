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
  std::filesystem::path image;  ///< empty: the generated picture
  std::uint64_t picture = 0;    ///< number of models::sign_picture
  double width = 0.3;           ///< [m]

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SignParameters;
    v.field("id", &P::id, unit::one, "identity as a landmark", at_least(0));
    v.field("image", &P::image, "file of its picture; absent: the generated one");
    v.field("picture", &P::picture, "number of the generated picture (models/sign_picture.hpp)");
    v.field("width_cm", &P::width, unit::centimetre, "width of the sign", positive());
  }
};

struct SignDetectorParameters {
  std::vector<SignParameters> catalogue;
  int features = 450;            ///< of a picture, at most
  int fast_threshold = 20;       ///< contrast of a corner [grey levels]
  double ratio = 0.85;           ///< of the distances of the best and the second best descriptor
  int min_matches = 4;           ///< that agree on one view
  int min_homography = 10;       ///< from so many on the view is a homography, else affine
  double inlier_px = 3.0;        ///< largest distance of a match from the view
  double min_side_px = 20.0;     ///< smaller pictures of a sign are left out
  double min_correlation = 0.8;  ///< of the sign's picture with the image
  double max_structure = 0.4;    ///< share of the picture left over in shapes: prints in real light leave 0.2 and more

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = SignDetectorParameters;
    v.list("catalogue", &P::catalogue, "signs that can be met");
    v.field("features", &P::features, unit::one, "features of an image at most", between(50, 5000));
    v.field("fast_threshold", &P::fast_threshold, unit::one, "contrast of a feature in grey levels", between(2, 100));
    v.field("ratio", &P::ratio, unit::one, "largest ratio of the distances to the best and second best descriptor",
            between(0.3, 1.0));
    v.field("min_matches", &P::min_matches, unit::one, "fewest matches that agree on one view", at_least(3));
    v.field("min_homography", &P::min_homography, unit::one,
            "from so many matches on the view is taken for a homography, else for affine", at_least(5));
    v.field("inlier_px", &P::inlier_px, unit::one, "largest distance of a match from the view in pixels", positive());
    v.field("min_side_px", &P::min_side_px, unit::one, "smaller pictures of a sign are left out", at_least(8.0));
    v.field("min_correlation", &P::min_correlation, unit::one,
            "least correlation of the sign's picture with the image, once aligned", between(0.0, 1.0));
    v.field("max_structure", &P::max_structure, unit::one,
            "largest share of the picture's variance left over in shapes; 0.05 where pictures are drawn",
            between(0.0, 1.0));
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
