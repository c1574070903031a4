#include "sensors/camera/motion_saliency.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/check.hpp"
#include "core/limits.hpp"
#include "sensors/camera/grey_image.hpp"

namespace noctule::sensors {
namespace {

constexpr int kGreatestWidth = 320;  // of the image worked on
constexpr int kLeastCorners = 12;    // fewer say nothing about the camera

/// What takes pixels of the frame before to the present one; nothing when the corners do not agree.
cv::Mat camera_motion(const cv::Mat& before, const cv::Mat& now, const MotionSaliencyParameters& p) {
  if (p.ego_motion == EgoMotion::none) return {};
  std::vector<cv::Point2f> from, to;
  cv::goodFeaturesToTrack(before, from, p.corners, 0.01, 8.0);
  if (std::ssize(from) < kLeastCorners) return {};
  std::vector<std::uint8_t> found;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(before, now, from, to, found, errors, cv::Size(15, 15), 3,
                           cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 15, 0.02));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (found[i] == 0) continue;
    from[kept] = from[i];
    to[kept++] = to[i];
  }
  from.resize(kept);
  to.resize(kept);
  if (std::ssize(from) < kLeastCorners) return {};
  std::vector<std::uint8_t> agree;
  cv::Mat motion;
  if (p.ego_motion == EgoMotion::homography) {
    motion = cv::findHomography(from, to, cv::RANSAC, 1.5, agree, 500);
  } else {
    const cv::Mat affine = cv::estimateAffinePartial2D(from, to, agree, cv::RANSAC, 1.5, 500);
    if (!affine.empty()) {
      motion = cv::Mat::eye(3, 3, CV_64F);
      affine.copyTo(motion.rowRange(0, 2));
    }
  }
  const auto agreeing = std::ranges::count_if(agree, [](std::uint8_t v) { return v != 0; });
  if (motion.empty() || agreeing < kLeastCorners ||
      static_cast<double>(agreeing) < p.least_inliers * static_cast<double>(kept))
    return {};
  const double scale = cv::determinant(motion.rowRange(0, 2).colRange(0, 2));
  return cv::checkRange(motion) && scale > 0.25 && scale < 4.0 ? motion : cv::Mat();
}

}  // namespace

struct MotionSaliency::Frames {
  cv::Mat full, grey, blurred;  ///< the latter two: shrunk
  cv::Mat last_grey, last_blurred;
  cv::Mat moved, white, inside, difference;
};

MotionSaliency::MotionSaliency(const MotionSaliencyParameters& parameters)
    : parameters_(parameters), frames_(std::make_unique<Frames>()) {
  require_sound(parameters_, "motion saliency");
}
MotionSaliency::~MotionSaliency() = default;
MotionSaliency::MotionSaliency(MotionSaliency&&) noexcept = default;
MotionSaliency& MotionSaliency::operator=(MotionSaliency&&) noexcept = default;

std::size_t MotionSaliency::cell_at(int column, int row) const {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
}

void MotionSaliency::update(const Image& image) {
  Frames& f = *frames_;
  if (width_ == 0) {
    check_image(image, "motion saliency");
    width_ = image.width;
    height_ = image.height;
    columns_ = static_cast<int>(std::ceil(width_ / parameters_.cell));
    rows_ = static_cast<int>(std::ceil(height_ / parameters_.cell));
    cells_.resize(cell_at(0, rows_));
    pooled_.resize(cells_.size());
    sums_.resize(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1));
  } else {
    check_image(image, "motion saliency", width_, height_);
  }
  std::swap(f.grey, f.last_grey);
  std::swap(f.blurred, f.last_blurred);
  const int shrink = std::max(1, (width_ + kGreatestWidth - 1) / kGreatestWidth);
  grey_image(image, shrink, f.full, f.grey);
  cv::GaussianBlur(f.grey, f.blurred, {}, std::max(0.5, parameters_.blur / shrink));
  std::ranges::fill(cells_, 0.0);
  compensated_ = false;
  moving_share_ = 0.0;
  if (f.last_grey.empty()) return;

  const cv::Mat motion = camera_motion(f.last_grey, f.grey, parameters_);
  compensated_ = !motion.empty();
  if (compensated_) {
    cv::warpPerspective(f.last_blurred, f.moved, motion, f.blurred.size(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, 0);
    if (f.white.empty()) f.white = cv::Mat(f.blurred.size(), CV_8U, cv::Scalar(255));
    cv::warpPerspective(f.white, f.inside, motion, f.blurred.size(), cv::INTER_NEAREST, cv::BORDER_CONSTANT, 0);
    cv::erode(f.inside, f.inside, cv::Mat(), {-1, -1}, 2, cv::BORDER_CONSTANT, 255);
    cv::absdiff(f.blurred, f.moved, f.difference);
    cv::bitwise_and(f.difference, f.inside, f.difference);  // what came into view does not move
  } else {
    cv::absdiff(f.blurred, f.last_blurred, f.difference);
  }
  cv::Scalar mean, sd;
  cv::meanStdDev(f.difference, mean, sd);
  const double threshold = std::max(parameters_.least_difference, mean[0] + parameters_.deviations * sd[0]);
  std::size_t moving = 0;
  const double by_cell = shrink / parameters_.cell;
  for (int v = 0; v < f.difference.rows; ++v) {
    const std::uint8_t* const line = f.difference.ptr<std::uint8_t>(v);
    const int row = std::min(static_cast<int>((v + 0.5) * by_cell), rows_ - 1);
    for (int u = 0; u < f.difference.cols; ++u) {
      if (line[u] <= threshold) continue;
      ++moving;
      cells_[cell_at(std::min(static_cast<int>((u + 0.5) * by_cell), columns_ - 1), row)] += line[u];
    }
  }
  moving_share_ = static_cast<double>(moving) / static_cast<double>(f.difference.total());
}

void MotionSaliency::prepare(const Vector2& size, double uniform_share) {
  const auto sum_at = [&](int column, int row) -> double& {
    return sums_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_ + 1) +
                 static_cast<std::size_t>(column)];
  };
  for (int row = 0; row < rows_; ++row) {
    double line = 0.0;
    for (int column = 0; column < columns_; ++column) {
      line += cells_[cell_at(column, row)];
      sum_at(column + 1, row + 1) = sum_at(column + 1, row) + line;
    }
  }
  const double total = sum_at(columns_, rows_);
  const int across = std::max(0, static_cast<int>(0.25 * size.x() / parameters_.cell));
  const int down = std::max(0, static_cast<int>(0.25 * size.y() / parameters_.cell));
  double pooled = 0.0;
  for (int row = 0; row < rows_ && total > 0.0; ++row) {
    const int top = std::max(row - down, 0), bottom = std::min(row + down + 1, rows_);
    for (int column = 0; column < columns_; ++column) {
      const int left = std::max(column - across, 0), right = std::min(column + across + 1, columns_);
      const double sum = sum_at(right, bottom) - sum_at(left, bottom) - sum_at(right, top) + sum_at(left, top);
      pooled_[cell_at(column, row)] = sum;
      pooled += sum;
    }
  }
  // Cells at the right and lower edge may be smaller: the uniform part is by area.
  const double share = pooled > 0.0 ? std::max(parameters_.uniform_share, uniform_share) : 1.0;
  const double area = static_cast<double>(width_) * height_;
  for (std::size_t i = 0; i < pooled_.size(); ++i) {
    const double moving = pooled > 0.0 ? pooled_[i] / pooled : 0.0;
    pooled_[i] = (1.0 - share) * moving + share * cell_size(i).prod() / area;
  }
  table_.assign(pooled_);
}

Vector2 MotionSaliency::cell_size(std::size_t cell) const {
  const auto column = static_cast<double>(cell % static_cast<std::size_t>(columns_));
  const auto row = static_cast<double>(cell / static_cast<std::size_t>(columns_));
  return {std::min(parameters_.cell, width_ - column * parameters_.cell),
          std::min(parameters_.cell, height_ - row * parameters_.cell)};
}

Vector2 MotionSaliency::draw(Rng& rng) const {
  const std::size_t cell = table_.draw(rng);
  const Vector2 size = cell_size(cell);
  const double u = rng.uniform() * size.x(), v = rng.uniform() * size.y();
  return {static_cast<double>(cell % static_cast<std::size_t>(columns_)) * parameters_.cell + u - 0.5,
          static_cast<double>(cell / static_cast<std::size_t>(columns_)) * parameters_.cell + v - 0.5};
}

double MotionSaliency::log_density(const Vector2& place) const {
  const double u = place.x() + 0.5, v = place.y() + 0.5;
  if (!(u >= 0.0 && v >= 0.0 && u < width_ && v < height_)) return -kInf;
  const std::size_t cell = cell_at(std::min(static_cast<int>(u / parameters_.cell), columns_ - 1),
                                   std::min(static_cast<int>(v / parameters_.cell), rows_ - 1));
  return std::log(table_.probability(cell) / cell_size(cell).prod());
}

double MotionSaliency::log_uniform_density() const {
  return -std::log(static_cast<double>(width_) * height_);
}

}  // namespace noctule::sensors
