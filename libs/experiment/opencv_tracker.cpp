#include "experiment/opencv_tracker.hpp"

#include <opencv2/imgproc.hpp>
#include <opencv2/tracking.hpp>

#include "sensors/camera/opencv.hpp"

namespace noctule::experiment {

struct OpencvTracker::Tracker {
  cv::Ptr<cv::Tracker> tracker;
  cv::Mat colour;

  /// They want colours.
  const cv::Mat& prepared(const Image& image) {
    const cv::Mat view = sensors::as_mat(image);
    if (image.channels == 1) {
      cv::cvtColor(view, colour, cv::COLOR_GRAY2BGR);
    } else {
      view.copyTo(colour);
    }
    return colour;
  }
};

OpencvTracker::OpencvTracker(const std::string& name) : tracker_(std::make_unique<Tracker>()) {
  cv::setNumThreads(1);  // times are those of one core
  if (name == "opencv_kcf") {
    tracker_->tracker = cv::TrackerKCF::create();
  } else {
    tracker_->tracker = cv::TrackerCSRT::create();
  }
}
OpencvTracker::~OpencvTracker() = default;

void OpencvTracker::start(const Image& image, const ImageBox& target) {
  const Vector2 corner = target.centre - 0.5 * target.size + Vector2(0.5, 0.5);
  tracker_->tracker->init(tracker_->prepared(image), cv::Rect(cvRound(corner.x()), cvRound(corner.y()),
                                                              cvRound(target.size.x()), cvRound(target.size.y())));
  box_ = target;
}

const ImageBox& OpencvTracker::track(const Image& image) {
  cv::Rect r;
  if (!tracker_->tracker->update(tracker_->prepared(image), r)) return box_;
  const Vector2 size(r.width, r.height);
  box_ = {Vector2(r.x - 0.5, r.y - 0.5) + 0.5 * size, size};
  return box_;
}

}  // namespace noctule::experiment
