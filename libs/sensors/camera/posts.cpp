#include "sensors/camera/posts.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/check.hpp"
#include "core/chi2.hpp"
#include "sensors/camera/opencv.hpp"

namespace noctule::sensors {
namespace {

/// What of a colour is no grey, in a plane: its length over the brightness is the saturation, its direction the hue.
Vector2 chroma(double red, double green, double blue) {
  return {red - 0.5 * (green + blue), 0.5 * std::sqrt(3.0) * (green - blue)};
}

/// One edge of a post: azimuths over its rows.
struct Edge {
  double azimuth = 0.0;
  double variance = 0.0;
  Vector2 top, bottom;  // pixels
};

class PostDetector final : public LandmarkDetector {
 public:
  PostDetector(const PostDetectorParameters& parameters, const models::CameraIntrinsics& camera,
               const models::CameraMounting& mounting)
      : LandmarkDetector(camera, mounting), parameters_(parameters) {}

 protected:
  void find(const CameraImage& image, const Image&, std::span<const LandmarkPrediction>,
            std::vector<CameraFinding>& found) override {
    if (image.image.channels != 3) return;
    cv::Mat smooth;
    cv::blur(as_mat(image.image), smooth, {3, 3});
    for (const PostParameters& post : parameters_.catalogue)
      if (auto finding = locate(smooth, post)) found.push_back(std::move(*finding));
  }

 private:
  /// How much of the post's hue each pixel has, in grey levels; 0 for other hues.
  [[nodiscard]] cv::Mat similarity(const cv::Mat& image, const PostParameters& post) const {
    const Vector2 hue = chroma(post.colour[0], post.colour[1], post.colour[2]).normalized();
    const double slope = std::tan(parameters_.hue_gate);
    cv::Mat result(image.size(), CV_32F);
    for (int y = 0; y < image.rows; ++y) {
      const auto* p = image.ptr<cv::Vec3b>(y);
      auto* out = result.ptr<float>(y);
      for (int x = 0; x < image.cols; ++x) {
        const Vector2 c = chroma(p[x][2], p[x][1], p[x][0]);
        const double along = hue.dot(c), across = std::abs(hue.x() * c.y() - hue.y() * c.x());
        const double brightest = std::max({p[x][0], p[x][1], p[x][2]});
        const bool like = across < slope * along && along > parameters_.min_saturation * brightest && along > kLeast;
        out[x] = like ? static_cast<float>(along) : 0.0F;
      }
    }
    return result;
  }

  [[nodiscard]] std::optional<CameraFinding> locate(const cv::Mat& image, const PostParameters& post) const {
    const cv::Mat like = similarity(image, post);
    const cv::Mat mask = like > 0.0F;
    cv::Mat labels, stats, middles;
    const int count = cv::connectedComponentsWithStats(mask, labels, stats, middles, 8, CV_32S);
    std::optional<CameraFinding> best;
    int best_area = 0;
    for (int label = 1; label < count; ++label) {
      const cv::Rect box(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                         stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
      const int area = stats.at<int>(label, cv::CC_STAT_AREA);
      if (area <= best_area || box.width < parameters_.min_width_px || box.height < box.width ||
          area < 0.7 * box.area() || box.x <= 1 || box.x + box.width >= image.cols - 1)
        continue;
      if (auto finding = measure(image, box, post)) {
        best = std::move(finding);
        best_area = area;
      }
    }
    return best;
  }

  [[nodiscard]] std::optional<CameraFinding> measure(const cv::Mat& image, const cv::Rect& box,
                                                     const PostParameters& post) const {
    const auto left = edge(image, box, post, true), right = edge(image, box, post, false);
    if (!left || !right) return std::nullopt;
    const double half = 0.5 * wrap(left->azimuth - right->azimuth);
    if (!(half > 1e-4) || half > radians(60.0)) return std::nullopt;

    CameraFinding finding;
    LandmarkDetection& d = finding.detection;
    d.id = post.id;
    d.range = post.radius / std::sin(half);
    d.bearing = wrap(right->azimuth + half - mounting().yaw);
    const double by_half = -d.range / std::tan(half);
    Matrix2 by;  // of range and bearing, by the left and the right azimuth
    by << 0.5 * by_half, -0.5 * by_half, 0.5, 0.5;
    d.covariance = by * Vector2(left->variance, right->variance).asDiagonal() * by.transpose();
    finding.outline = {left->top, right->top, right->bottom, left->bottom};
    if (!stands(image, box, post, d)) return std::nullopt;
    return finding;
  }

  /// Mean azimuth of one side: in each row the place where the hue has fallen to half of what it is inside.
  [[nodiscard]] std::optional<Edge> edge(const cv::Mat& image, const cv::Rect& box, const PostParameters& post,
                                         bool left) const {
    const Vector2 hue = chroma(post.colour[0], post.colour[1], post.colour[2]).normalized();
    const auto along = [&](int x, int y) {
      const cv::Vec3b& p = image.at<cv::Vec3b>(y, x);
      return hue.dot(chroma(p[2], p[1], p[0]));
    };
    const int margin = std::max(2, box.height / 10);
    const int inwards = left ? 1 : -1;
    std::vector<double> azimuths, noise;
    std::vector<Vector2> pixels;
    for (int y = box.y + margin; y < box.y + box.height - margin; ++y) {
      const int start = left ? box.x : box.x + box.width - 1;
      const int reach = std::max(2, box.width / 4);
      double inside = 0.0;
      for (int k = 1; k <= 3; ++k) inside += along(start + inwards * std::min(reach, k + 2), y) / 3.0;
      const int out = start - 3 * inwards;
      if (out < 0 || out >= image.cols) continue;
      const double outside = along(out, y);
      if (!(inside - outside > kLeast)) continue;
      const double level = 0.5 * (inside + outside);
      for (int k = -3; k < reach; ++k) {
        const int x = start + k * inwards;
        const double here = along(x, y), next = along(x + inwards, y);
        if (here > level || next <= level) continue;
        const Vector2 pixel(x + inwards * (level - here) / (next - here), y);
        const auto ray = models::unproject(camera(), pixel);
        if (!ray) break;
        const Matrix3 per_pixel2 =
            (Matrix3() << ray->by_pixel * ray->by_pixel.transpose(), Vector2::Zero(), Vector3::Zero().transpose())
                .finished();
        const LandmarkDetection seen = plane_sighting(mounting(), ray->direction.homogeneous(), per_pixel2);
        azimuths.push_back(seen.bearing);
        noise.push_back(seen.covariance(1, 1));
        pixels.push_back(pixel);
        break;
      }
    }
    if (azimuths.size() < 5) return std::nullopt;
    std::vector<double> sorted = azimuths;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double median = *middle;
    // Rows within two pixels of the median; the others show something else.
    double sum = 0.0, square = 0.0, per_pixel2 = 0.0;
    int n = 0;
    for (std::size_t i = 0; i < azimuths.size(); ++i) {
      const double off = azimuths[i] - median;
      if (off * off > 4.0 * noise[i]) continue;
      sum += off, square += off * off, per_pixel2 += noise[i], ++n;
    }
    if (n < 5 || n < static_cast<int>(azimuths.size()) / 2) return std::nullopt;
    const double mean = sum / n;
    const double spread = std::max(0.0, square / n - mean * mean);
    Edge e;
    e.azimuth = wrap(median + mean + mounting().yaw);
    e.variance = per_pixel2 / n * parameters_.edge_sd_px * parameters_.edge_sd_px + 3.0 * spread / n;
    e.top = pixels.front();
    e.bottom = pixels.back();
    return e;
  }

  /// Whether foot and top, where they are seen, are where a post at this range has them.
  [[nodiscard]] bool stands(const cv::Mat& image, const cv::Rect& box, const PostParameters& post,
                            const LandmarkDetection& d) const {
    constexpr double kGate = 3.5;  // sd
    const double column = box.x + 0.5 * (box.width - 1);
    const double front = d.range - post.radius;
    if (!(front > 0.0)) return false;
    if (parameters_.check_ground && box.y + box.height < image.rows - 1) {
      GroundParameters far = parameters_.ground;
      far.max_range = 1e3;
      const auto foot = ground_contact(camera(), mounting(), Vector2(column, box.y + box.height - 0.5), far);
      if (!foot) return false;
      if (std::abs(foot->range - front) > kGate * std::sqrt(foot->covariance(0, 0) + d.covariance(0, 0))) return false;
    }
    if (post.height > 0.0 && box.y > 1) {
      const Vector3 top = point_of_sighting(mounting(), front, d.bearing, post.height);
      const auto pixel = models::project(camera(), top);
      if (!pixel) return false;
      const double by_range = camera().fy * std::abs(post.height - mounting().height) / (front * front);
      const double sd =
          std::hypot(2.0 + camera().fy * parameters_.ground.pitch_sd, by_range * std::sqrt(d.covariance(0, 0)));
      if (std::abs(pixel->pixel.y() - (box.y - 0.5)) > kGate * sd) return false;
    }
    return true;
  }

  static constexpr double kLeast = 20.0;  // grey levels of colour that count as colour

  PostDetectorParameters parameters_;
};

}  // namespace

std::string PostDetectorParameters::validate() const {
  std::set<std::int64_t> ids;
  for (const PostParameters& post : catalogue) {
    if (!ids.insert(post.id).second)
      return "catalogue: expected each id once, got " + std::to_string(post.id) + " again";
    if (post.colour.size() != 3)
      return "catalogue: colour_rgb: expected 3 numbers, got " + std::to_string(post.colour.size());
    if (chroma(post.colour[0], post.colour[1], post.colour[2]).norm() < 40.0)
      return "catalogue: colour_rgb: expected a colour that is not grey";
  }
  return catalogue.empty() ? "catalogue: expected one post at least" : "";
}

std::unique_ptr<LandmarkDetector> make_post_detector(const PostDetectorParameters& parameters,
                                                     const models::CameraIntrinsics& camera,
                                                     const models::CameraMounting& mounting) {
  require_sound(parameters, "posts");
  return std::make_unique<PostDetector>(parameters, camera, mounting);
}

}  // namespace noctule::sensors
