#include "sensors/camera/signs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/check.hpp"
#include "models/sign_picture.hpp"
#include "sensors/camera/descriptors.hpp"
#include "sensors/camera/opencv.hpp"
#include "sensors/camera/planar_alignment.hpp"

namespace noctule::sensors {
namespace {

constexpr int kPictureSide = 384;  // of a generated picture [pixels]
/// Sides [pixels] at which the features of a sign are learnt; in between the levels of the image's pyramid help.
constexpr std::array<double, 3> kLearntSides{40.0, 66.0, 110.0};
constexpr int kLearntFeatures = 80;  // of each
constexpr double kLevelStep = 1.2;
constexpr int kLevels = 7;

/// A feature of the catalogue: where on which sign, and how large and turned it appears when the sign is one pixel per
/// metre.
struct SignFeature {
  std::size_t sign = 0;
  Vector2 place;  // from the middle [m]
  double size = 0.0;
  double angle = 0.0;  // [rad]
};

struct SignMatch {
  SignFeature feature;
  Vector2 pixel;
  double scale = 0.0;  // pixels per metre that it suggests
  double turn = 0.0;   // of the sign in the image [rad]
  Vector2 middle;      // of the sign in the image, if it is seen from the front

  [[nodiscard]] bool agrees(const SignMatch& other, double side) const {
    const double ratio = scale / other.scale;
    return ratio > 0.6 && ratio < 1.0 / 0.6 && std::abs(wrap(turn - other.turn)) < radians(35.0) &&
           (middle - other.middle).norm() < 0.4 * side * std::max(scale, other.scale);
  }
};

Descriptor descriptor_of(const cv::Mat& descriptors, std::size_t row) {
  Descriptor d;
  std::memcpy(d.data(), descriptors.ptr(static_cast<int>(row)), sizeof(d));
  return d;
}

PlanarPicture planar_picture(const SignParameters& sign, const PictureReader& read_picture) {
  Image image;
  if (sign.image.empty()) {
    image = models::sign_picture(sign.picture, kPictureSide);
  } else {
    if (!read_picture) throw InputError("signs: " + sign.image.string() + ": nobody here reads picture files");
    image = read_picture(sign.image);
  }
  if (!image.consistent() || image.width < 32 || image.height < 32) {
    throw InputError("signs: picture of sign " + std::to_string(sign.id) + ": expected at least 32 x 32 pixels, got " +
                     std::to_string(image.width) + " x " + std::to_string(image.height));
  }
  const double height = sign.width * image.height / image.width;
  if (image.channels == 3) {
    Image grey{image.width, image.height, 1, std::vector<std::uint8_t>(image.pixels.size() / 3)};
    cv::Mat target(grey.height, grey.width, CV_8UC1, grey.pixels.data());
    cv::cvtColor(as_mat(image), target, cv::COLOR_BGR2GRAY);
    image = std::move(grey);
  }
  return {std::move(image), sign.width, height};
}

/// Twice the signed area of a polygon of the image; above 0 when it turns as the picture's corners do.
double turning_area(const std::vector<Vector2>& corners) {
  double area = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2& a = corners[i];
    const Vector2& b = corners[(i + 1) % corners.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area;
}

/// Whether four corners can be a view of the front of a rectangle: convex, not mirrored, not a sliver.
bool plausible(const std::vector<Vector2>& corners, double min_side) {
  double shortest = 1e9, longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2 in = corners[(i + 1) % 4] - corners[i], out = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    if (!in.allFinite() || !(in.x() * out.y() - in.y() * out.x() > 0.0)) return false;
    shortest = std::min(shortest, in.norm());
    longest = std::max(longest, in.norm());
  }
  return shortest > 0.12 * longest && 0.5 * turning_area(corners) > min_side * min_side * 0.25 &&
         std::sqrt(0.5 * turning_area(corners)) >= 0.7 * min_side;
}

class SignDetector final : public LandmarkDetector {
 public:
  SignDetector(const SignDetectorParameters& parameters, const models::CameraIntrinsics& camera,
               const models::CameraMounting& mounting, const PictureReader& read_picture)
      : LandmarkDetector(camera, mounting),
        parameters_(parameters),
        finder_(cv::ORB::create(parameters.features, static_cast<float>(kLevelStep), kLevels, 16, 0, 2,
                                cv::ORB::FAST_SCORE, 31, parameters.fast_threshold)) {
    for (const SignParameters& sign : parameters.catalogue) {
      pictures_.push_back(planar_picture(sign, read_picture));
      for (const double side : kLearntSides) learn(pictures_.size() - 1, side);
    }
  }

 protected:
  void find(const CameraImage&, const Image& grey, std::span<const LandmarkPrediction> expected,
            std::vector<CameraFinding>& found) override {
    std::vector<std::vector<SignMatch>> matches(pictures_.size());
    match(grey, matches);
    for (std::size_t sign = 0; sign < pictures_.size(); ++sign) {
      const LandmarkPrediction* prediction = nullptr;
      for (const LandmarkPrediction& p : expected)
        if (p.id == parameters_.catalogue[sign].id) prediction = &p;
      if (auto finding = locate(grey, sign, matches[sign], prediction)) found.push_back(std::move(*finding));
    }
  }

 private:
  void learn(std::size_t sign, double side) {
    const PlanarPicture& picture = pictures_[sign];
    const double scale = side / std::sqrt(picture.width * picture.height);  // pixels per metre
    cv::Mat small;
    const cv::Size size(std::max(8, static_cast<int>(std::lround(picture.width * scale))),
                        std::max(8, static_cast<int>(std::lround(picture.height * scale))));
    cv::resize(as_mat(picture.grey), small, size, 0.0, 0.0, cv::INTER_AREA);
    constexpr int kBorder = 24;
    cv::copyMakeBorder(small, small, kBorder, kBorder, kBorder, kBorder, cv::BORDER_CONSTANT, cv::Scalar(128));
    cv::GaussianBlur(small, small, {}, 0.6);
    const auto learner = cv::ORB::create(kLearntFeatures, static_cast<float>(kLevelStep), 1, 16, 0, 2,
                                         cv::ORB::HARRIS_SCORE, 31, std::max(5, parameters_.fast_threshold / 2));
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    learner->detectAndCompute(small, cv::noArray(), points, descriptors);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const cv::KeyPoint& p = points[i];
      const Vector2 place((static_cast<double>(p.pt.x) + 0.5 - kBorder) / size.width - 0.5,
                          (static_cast<double>(p.pt.y) + 0.5 - kBorder) / size.height - 0.5);
      features_.push_back({sign, place.cwiseProduct(Vector2(picture.width, picture.height)),
                           static_cast<double>(p.size) / scale, radians(static_cast<double>(p.angle))});
      descriptors_.push_back(descriptor_of(descriptors, i));
      // One group per square of a tenth of the sign: there the sizes show the same corner.
      constexpr int kSquares = 10;
      const auto square = [](double x) { return std::clamp(static_cast<int>((x + 0.5) * kSquares), 0, kSquares - 1); };
      groups_.push_back((static_cast<int>(sign) * kSquares + square(place.x())) * kSquares + square(place.y()));
    }
  }

  /// Features of the image that are like one place of one sign, and like no other.
  void match(const Image& grey, std::vector<std::vector<SignMatch>>& matches) {
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    finder_->detectAndCompute(as_mat(grey), cv::noArray(), points, descriptors);
    if (descriptors.empty() || features_.empty()) return;
    constexpr int kFarthest = 72;  // bits
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto nearest =
          nearest_descriptor(descriptor_of(descriptors, i), descriptors_, groups_, kFarthest, parameters_.ratio);
      if (!nearest) continue;
      const SignFeature& best = features_[nearest->index];
      const cv::KeyPoint& p = points[i];
      SignMatch m{best, Vector2(static_cast<double>(p.pt.x), static_cast<double>(p.pt.y)),
                  static_cast<double>(p.size) / best.size, wrap(radians(static_cast<double>(p.angle)) - best.angle),
                  Vector2::Zero()};
      m.middle = m.pixel - m.scale * (Eigen::Rotation2Dd(m.turn) * best.place);
      matches[best.sign].push_back(m);
    }
  }

  std::optional<CameraFinding> locate(const Image& grey, std::size_t sign, const std::vector<SignMatch>& all,
                                      const LandmarkPrediction* prediction) {
    const PlanarPicture& picture = pictures_[sign];
    std::vector<SignMatch> matches;
    for (const SignMatch& m : all)
      if (!prediction || near(*prediction, m.middle)) matches.push_back(m);
    const std::size_t needed = static_cast<std::size_t>(std::max(3, parameters_.min_matches - (prediction ? 1 : 0)));
    for (int attempt = 0; attempt < 3; ++attempt) {
      // The largest set of matches that suggest the same view as one of them.
      const double side = std::sqrt(picture.width * picture.height);
      const SignMatch* centre = nullptr;
      std::size_t most = 0;
      for (const SignMatch& a : matches) {
        const auto agreeing = static_cast<std::size_t>(
            std::count_if(matches.begin(), matches.end(), [&](const SignMatch& b) { return a.agrees(b, side); }));
        if (agreeing > most) most = agreeing, centre = &a;
      }
      if (most < needed) return std::nullopt;
      std::vector<SignMatch> set, rest;
      for (const SignMatch& m : matches) (centre->agrees(m, side) ? set : rest).push_back(m);
      if (auto finding = measure(grey, sign, set)) return finding;
      matches = std::move(rest);
    }
    return std::nullopt;
  }

  std::optional<CameraFinding> measure(const Image& grey, std::size_t sign, const std::vector<SignMatch>& set) {
    const PlanarPicture& picture = pictures_[sign];
    const auto corners = corners_of(picture, set);
    if (!corners || !plausible(*corners, parameters_.min_side_px)) return std::nullopt;
    const auto start = pose_from_corners(camera(), picture, *corners);
    if (!start) return std::nullopt;
    const auto aligned = align_planar(camera(), grey, picture, *start);
    if (!aligned || aligned->correlation < parameters_.min_correlation) return std::nullopt;
    // Few matches say little: then the pixels must say it all.
    const bool many = set.size() >= static_cast<std::size_t>(parameters_.min_homography);
    constexpr double kStructureOfFew = 0.08;
    if (aligned->structure > (many ? parameters_.max_structure : std::min(kStructureOfFew, parameters_.max_structure)))
      return std::nullopt;
    auto outline = picture_outline(camera(), picture, aligned->pose);
    if (!outline || !plausible(*outline, parameters_.min_side_px)) return std::nullopt;
    CameraFinding finding{plane_sighting(mounting(), aligned->pose.translation, aligned->covariance),
                          std::move(*outline)};
    finding.detection.id = parameters_.catalogue[sign].id;
    finding.detection.score = aligned->correlation;
    return finding;
  }

  /// By a homography where the matches are many, else by an affine view.
  [[nodiscard]] std::optional<std::vector<Vector2>> corners_of(const PlanarPicture& picture,
                                                               const std::vector<SignMatch>& set) const {
    std::vector<cv::Point2d> on_sign, in_image;
    std::vector<double> scales;
    std::set<std::pair<double, double>> places;
    for (const SignMatch& m : set) {
      on_sign.emplace_back(m.feature.place.x(), m.feature.place.y());
      in_image.emplace_back(m.pixel.x(), m.pixel.y());
      scales.push_back(m.scale);
      places.emplace(m.feature.place.x(), m.feature.place.y());
    }
    if (places.size() < 3) return std::nullopt;
    std::nth_element(scales.begin(), scales.begin() + static_cast<std::ptrdiff_t>(scales.size() / 2), scales.end());
    const double side_px = scales[scales.size() / 2] * std::sqrt(picture.width * picture.height);
    const double inlier = std::max(parameters_.inlier_px, 0.03 * side_px);
    cv::Matx33d view = cv::Matx33d::zeros();
    const bool many = set.size() >= static_cast<std::size_t>(parameters_.min_homography);
    const cv::Mat found = many ? cv::findHomography(on_sign, in_image, cv::RANSAC, inlier)
                               : cv::estimateAffine2D(on_sign, in_image, cv::noArray(), cv::RANSAC, inlier);
    if (found.empty()) return std::nullopt;
    view(2, 2) = 1.0;
    for (int i = 0; i < found.rows; ++i)
      for (int j = 0; j < 3; ++j) view(i, j) = found.at<double>(i, j);
    std::vector<Vector2> corners;
    for (const Vector3& c : picture.corners()) {
      const cv::Vec3d p = view * cv::Vec3d(c.x(), c.y(), 1.0);
      if (!(p[2] > 0.0)) return std::nullopt;
      corners.emplace_back(p[0] / p[2], p[1] / p[2]);
    }
    return corners;
  }

  /// Whether a place in the image lies in the direction in which the sign is expected.
  [[nodiscard]] bool near(const LandmarkPrediction& prediction, const Vector2& pixel) const {
    constexpr double kGate = 4.0, kSlack = radians(3.0);
    const auto ray = models::unproject(camera(), pixel);
    if (!ray) return false;
    const LandmarkDetection seen = plane_sighting(mounting(), ray->direction.homogeneous(), Matrix3::Identity());
    return std::abs(wrap(seen.bearing - prediction.bearing)) < kGate * std::sqrt(prediction.covariance(1, 1)) + kSlack;
  }

  SignDetectorParameters parameters_;
  cv::Ptr<cv::ORB> finder_;
  std::vector<PlanarPicture> pictures_;
  std::vector<SignFeature> features_;
  std::vector<Descriptor> descriptors_;  // of features_
  std::vector<int> groups_;              // of features_
};

}  // namespace

std::string SignDetectorParameters::validate() const {
  std::set<std::int64_t> ids;
  for (const SignParameters& sign : catalogue) {
    if (!ids.insert(sign.id).second)
      return "catalogue: expected each id once, got " + std::to_string(sign.id) + " again";
  }
  return catalogue.empty() ? "catalogue: expected one sign at least" : "";
}

std::unique_ptr<LandmarkDetector> make_sign_detector(const SignDetectorParameters& parameters,
                                                     const models::CameraIntrinsics& camera,
                                                     const models::CameraMounting& mounting,
                                                     const PictureReader& read_picture) {
  require_sound(parameters, "signs");
  return std::make_unique<SignDetector>(parameters, camera, mounting, read_picture);
}

}  // namespace noctule::sensors
