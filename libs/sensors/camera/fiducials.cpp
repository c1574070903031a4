#include "sensors/camera/fiducials.hpp"

#include <algorithm>
#include <map>
#include <opencv2/aruco.hpp>

#include "core/check.hpp"
#include "sensors/camera/opencv.hpp"
#include "sensors/camera/planar_alignment.hpp"

namespace noctule::sensors {
namespace {

int opencv_name(MarkerFamily family) {
  switch (family) {
    case MarkerFamily::aruco_4x4_50:
      return cv::aruco::DICT_4X4_50;
    case MarkerFamily::aruco_5x5_100:
      return cv::aruco::DICT_5X5_100;
    case MarkerFamily::aruco_6x6_250:
      return cv::aruco::DICT_6X6_250;
    case MarkerFamily::aruco_7x7_1000:
      return cv::aruco::DICT_7X7_1000;
    case MarkerFamily::aruco_original:
      return cv::aruco::DICT_ARUCO_ORIGINAL;
    case MarkerFamily::april_16h5:
      return cv::aruco::DICT_APRILTAG_16h5;
    case MarkerFamily::april_25h9:
      return cv::aruco::DICT_APRILTAG_25h9;
    case MarkerFamily::april_36h10:
      return cv::aruco::DICT_APRILTAG_36h10;
    case MarkerFamily::april_36h11:
      return cv::aruco::DICT_APRILTAG_36h11;
  }
  throw std::invalid_argument("fiducials: a family without a dictionary");
}

constexpr int kTexels = 24;              // of a picture per cell of a marker
constexpr double kMostStructure = 0.08;  // left over where a marker is not quite in its place
constexpr int kWindow = 11;              // of the adaptive threshold [pixels]
constexpr double kThreshold = 7.0;       // below the mean of the window, at least [grey levels]

/// Sd of the noise, by the median of a difference that slopes and edges hardly move (Immerkaer: "Fast noise variance
/// estimation", 1996). Less than three of it above the threshold, every speck of noise would be a contour to follow.
double pixel_noise(const Image& grey) {
  constexpr int kStride = 5;
  constexpr double kMaskNorm = 6.0, kMedianPerSd = 0.6745;
  std::vector<int> magnitudes;
  for (int y = 1; y + 1 < grey.height; y += kStride) {
    const std::uint8_t* row = grey.pixels.data() + static_cast<std::ptrdiff_t>(y) * grey.width;
    const auto second = [&](const std::uint8_t* p) { return p[-1] - 2 * p[0] + p[1]; };
    for (int x = 1; x + 1 < grey.width; x += kStride) {
      const std::uint8_t* p = row + x;
      magnitudes.push_back(std::abs(second(p - grey.width) - 2 * second(p) + second(p + grey.width)));
    }
  }
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle / (kMaskNorm * kMedianPerSd);
}

class FiducialDetector final : public LandmarkDetector {
 public:
  FiducialDetector(const FiducialParameters& parameters, const models::CameraIntrinsics& camera,
                   const models::CameraMounting& mounting)
      : LandmarkDetector(camera, mounting),
        parameters_(parameters),
        dictionary_(cv::aruco::getPredefinedDictionary(opencv_name(parameters.family))),
        search_(cv::aruco::DetectorParameters::create()) {
    const double longest = std::max(camera.width, camera.height);
    search_->minMarkerPerimeterRate = 4.0 * parameters.min_side_px / longest;
    search_->adaptiveThreshWinSizeMin = search_->adaptiveThreshWinSizeMax = kWindow;
    // The white around a marker has a contour too, one cell outside; it must not replace the marker's.
    search_->minMarkerDistanceRate = 0.01;
  }

 protected:
  void find(const CameraImage&, const Image& grey, std::span<const LandmarkPrediction>,
            std::vector<CameraFinding>& found) override {
    search_->adaptiveThreshConstant = std::max(kThreshold, 3.0 * pixel_noise(grey));
    std::vector<std::vector<cv::Point2f>> quads;
    std::vector<int> ids;
    cv::aruco::detectMarkers(as_mat(grey), dictionary_, quads, ids, search_);
    std::map<int, CameraFinding> best;  // by id: the order of what is found
    for (std::size_t i = 0; i < ids.size(); ++i) {
      auto finding = measure(grey, ids[i], quads[i]);
      if (!finding) continue;
      const auto [at, is_new] = best.try_emplace(ids[i], *finding);
      if (!is_new && finding->detection.score > at->second.detection.score) at->second = *finding;
    }
    for (auto& [id, finding] : best) found.push_back(std::move(finding));
  }

 private:
  std::optional<CameraFinding> measure(const Image& grey, int id, const std::vector<cv::Point2f>& quad) {
    const PlanarPicture& framed = picture(id);
    const PlanarPicture black{{}, parameters_.side, parameters_.side};
    std::vector<Vector2> corners;
    for (const cv::Point2f& p : quad) corners.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y));
    const auto start = pose_from_corners(camera(), black, corners);
    if (!start) return std::nullopt;
    const auto aligned = align_planar(camera(), grey, framed, *start);
    if (!aligned || aligned->correlation < parameters_.min_correlation || aligned->structure > kMostStructure)
      return std::nullopt;
    auto outline = picture_outline(camera(), black, aligned->pose);
    if (!outline) return std::nullopt;
    CameraFinding finding{plane_sighting(mounting(), aligned->pose.translation, aligned->covariance),
                          std::move(*outline)};
    finding.detection.id = parameters_.first_id + id;
    finding.detection.score = aligned->correlation;
    return finding;
  }

  /// The marker with half a cell of white around it.
  const PlanarPicture& picture(int id) {
    const auto [at, is_new] = pictures_.try_emplace(id);
    if (is_new) {
      const int cells = dictionary_->markerSize + 2, border = kTexels / 2;
      cv::Mat marker;
      dictionary_->drawMarker(id, cells * kTexels, marker);
      cv::copyMakeBorder(marker, marker, border, border, border, border, cv::BORDER_CONSTANT, cv::Scalar(255));
      const double side = parameters_.side * (cells + 1.0) / cells;
      at->second = {
          {marker.cols, marker.rows, 1, {marker.begin<std::uint8_t>(), marker.end<std::uint8_t>()}}, side, side};
    }
    return at->second;
  }

  FiducialParameters parameters_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> search_;
  std::map<int, PlanarPicture> pictures_;
};

}  // namespace

std::unique_ptr<LandmarkDetector> make_fiducial_detector(const FiducialParameters& parameters,
                                                         const models::CameraIntrinsics& camera,
                                                         const models::CameraMounting& mounting) {
  require_sound(parameters, "fiducials");
  return std::make_unique<FiducialDetector>(parameters, camera, mounting);
}

}  // namespace noctule::sensors
