#include "sensors/camera/keypoints.hpp"

#include <algorithm>
#include <cstring>
#include <deque>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/check.hpp"
#include "sensors/camera/descriptors.hpp"
#include "sensors/camera/opencv.hpp"

namespace noctule::sensors {
namespace {

class KeypointDetector final : public LandmarkDetector {
 public:
  KeypointDetector(const KeypointParameters& parameters, const models::CameraIntrinsics& camera,
                   const models::CameraMounting& mounting)
      : LandmarkDetector(camera, mounting), parameters_(parameters), describer_(cv::ORB::create(1)) {}

 protected:
  void find(const CameraImage&, const Image& grey, std::span<const LandmarkPrediction>,
            std::vector<CameraFinding>& found) override {
    const cv::Mat now = as_mat(grey);
    follow(now);
    for (Track& t : tracks_) {
      if (t.frames < parameters_.stable_frames) continue;
      if (t.id < 0) t.id = identity_of(t);
      if (auto finding = sight(t)) found.push_back(std::move(*finding));
    }
    // Those that start in this picture are no landmarks yet.
    start(now);
    now.copyTo(before_);
  }

 private:
  struct Track {
    cv::Point2f at;
    int frames = 1;
    Descriptor first{};
    std::int64_t id = -1;
  };
  struct Lost {
    Descriptor descriptor{};
    std::int64_t id = -1;
  };

  void follow(const cv::Mat& now) {
    if (tracks_.empty()) return;
    std::vector<cv::Point2f> from, to, back;
    for (const Track& t : tracks_) from.push_back(t.at);
    std::vector<unsigned char> forth_found, back_found;
    std::vector<float> errors;
    const cv::Size window(15, 15);
    constexpr int kLevels = 3;
    cv::calcOpticalFlowPyrLK(before_, now, from, to, forth_found, errors, window, kLevels);
    cv::calcOpticalFlowPyrLK(now, before_, to, back, back_found, errors, window, kLevels);
    std::vector<Track> followed;
    const std::vector<std::optional<Descriptor>> descriptors = describe(now, to);
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      Track t = tracks_[i];
      const bool home =
          forth_found[i] != 0 && back_found[i] != 0 && cv::norm(back[i] - from[i]) < parameters_.return_px;
      const bool alone = std::none_of(followed.begin(), followed.end(), [&](const Track& other) {
        return cv::norm(other.at - to[i]) < 0.25 * parameters_.apart_px;
      });
      if (home && alone && descriptors[i] && hamming(*descriptors[i], t.first) <= parameters_.max_bits) {
        t.at = to[i];
        ++t.frames;
        followed.push_back(t);
      } else if (t.id >= 0) {
        lost_.push_back({t.first, t.id});
        if (lost_.size() > static_cast<std::size_t>(parameters_.memory)) lost_.pop_front();
      }
    }
    tracks_ = std::move(followed);
  }

  void start(const cv::Mat& now) {
    const int missing = parameters_.keypoints - static_cast<int>(tracks_.size());
    if (missing <= 0) return;
    cv::Mat free(now.size(), CV_8UC1, cv::Scalar(255));
    for (const Track& t : tracks_)
      cv::circle(free, t.at, static_cast<int>(parameters_.apart_px), cv::Scalar(0), cv::FILLED);
    constexpr double kQuality = 0.05, kLeastContrast = 8.0;
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(now, corners, missing, kQuality, parameters_.apart_px, free);
    const std::vector<std::optional<Descriptor>> descriptors = describe(now, corners);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (!descriptors[i]) continue;
      const cv::Rect around(cvRound(corners[i].x) - 7, cvRound(corners[i].y) - 7, 15, 15);
      cv::Scalar mean, sd;
      cv::meanStdDev(now(around), mean, sd);
      if (sd[0] < kLeastContrast) continue;
      tracks_.push_back({corners[i], 1, *descriptors[i], -1});
    }
  }

  /// Nothing near the border of the image.
  [[nodiscard]] std::vector<std::optional<Descriptor>> describe(const cv::Mat& image,
                                                                const std::vector<cv::Point2f>& points) const {
    std::vector<std::optional<Descriptor>> result(points.size());
    std::vector<cv::KeyPoint> keypoints;
    constexpr float kPatch = 31.0F;
    constexpr int kBorder = 20;
    const cv::Rect inside(kBorder, kBorder, image.cols - 2 * kBorder, image.rows - 2 * kBorder);
    for (std::size_t i = 0; i < points.size(); ++i) {
      // Upright: a robot's camera does not roll.
      if (inside.contains(points[i])) keypoints.emplace_back(points[i], kPatch, 0.0F, 0.0F, 0, static_cast<int>(i));
    }
    if (keypoints.empty()) return result;
    cv::Mat descriptors;
    describer_->compute(image, keypoints, descriptors);
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
      Descriptor d;
      std::memcpy(d.data(), descriptors.ptr(static_cast<int>(k)), sizeof(d));
      result[static_cast<std::size_t>(keypoints[k].class_id)] = d;
    }
    return result;
  }

  std::int64_t identity_of(const Track& track) {
    std::vector<Descriptor> known;
    std::vector<int> groups;
    for (const Lost& l : lost_) {
      known.push_back(l.descriptor);
      groups.push_back(static_cast<int>(groups.size()));
    }
    constexpr int kSame = 40;  // bits
    constexpr double kRatio = 0.7;
    const auto nearest = nearest_descriptor(track.first, known, groups, kSame, kRatio);
    if (!nearest) return parameters_.first_id + next_++;
    const auto at = lost_.begin() + static_cast<std::ptrdiff_t>(nearest->index);
    const std::int64_t id = at->id;
    lost_.erase(at);
    return id;
  }

  [[nodiscard]] std::optional<CameraFinding> sight(const Track& track) const {
    const Vector2 pixel(static_cast<double>(track.at.x), static_cast<double>(track.at.y));
    const auto ray = models::unproject(camera(), pixel);
    if (!ray) return std::nullopt;
    const Eigen::Matrix<double, 3, 2> spread =
        (Eigen::Matrix<double, 3, 2>() << ray->by_pixel * parameters_.pixel_sd, Vector2::Zero().transpose()).finished();
    CameraFinding finding{plane_sighting(mounting(), ray->direction.homogeneous(), spread * spread.transpose()),
                          {pixel}};
    LandmarkDetection& d = finding.detection;
    d.kind = DetectionKind::bearing_only;
    d.range = 0.0;
    d.covariance = Vector2(0.0, d.covariance(1, 1)).asDiagonal();
    d.id = track.id;
    return finding;
  }

  KeypointParameters parameters_;
  cv::Ptr<cv::ORB> describer_;
  cv::Mat before_;
  std::vector<Track> tracks_;
  std::deque<Lost> lost_;
  std::int64_t next_ = 0;
};

}  // namespace

std::unique_ptr<LandmarkDetector> make_keypoint_detector(const KeypointParameters& parameters,
                                                         const models::CameraIntrinsics& camera,
                                                         const models::CameraMounting& mounting) {
  require_sound(parameters, "keypoints");
  return std::make_unique<KeypointDetector>(parameters, camera, mounting);
}

}  // namespace noctule::sensors
