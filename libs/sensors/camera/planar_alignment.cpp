#include "sensors/camera/planar_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "sensors/camera/opencv.hpp"

namespace noctule::sensors {
namespace {

constexpr double kLargest = 72.0;      // side of the picture, in blocks of pixels
constexpr double kOversampling = 2.0;  // texels of the drawn picture per block
constexpr int kFewest = 60;            // blocks
constexpr int kMost = 1200;            // blocks; of more only every second, third ... is used
constexpr int kSteps = 12;             // of a descent, at most
constexpr double kGain = 3e-5;         // of a step below which the descent ends, in shares of the cost
constexpr double kAmbiguous = 60.0;    // side of a picture below which its mirrored tilt is tried too [pixels]
constexpr int kUnknowns = 9;           // three of place, three of rotation, brightness, contrast, blur
constexpr std::array<double, 5> kBlurs{0.4, 0.7, 1.1, 1.7, 2.6};  // sd in blocks that are tried

constexpr double kStructure = 0.02;      // share of the picture's variance left over in shapes, not noise: suspicious
constexpr double kTilt = radians(30.0);  // of other starts then
constexpr double kCornerFloor = 0.05;    // pixels

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Information = Eigen::Matrix<double, kUnknowns, kUnknowns>;

/// One block of pixels: what it shows, and its ray.
struct Block {
  Vector3 ray;
  double value = 0.0;
  int column = 0, row = 0;
};

/// The image around the picture, shrunk by a whole factor.
struct Patch {
  cv::Mat blocks;  // float
  cv::Point first;
  int factor = 1;

  [[nodiscard]] Vector2 pixel(int column, int row) const {
    return {first.x + (column + 0.5) * factor - 0.5, first.y + (row + 0.5) * factor - 0.5};
  }
};

/// The picture as the camera would draw it at this size, with its slopes per metre.
struct Drawing {
  cv::Mat value, by_x, by_y;  // float
  cv::Mat bend;               // Laplacian per block: what a little more blur adds
  double width = 0.0, height = 0.0;
  double margin_x = 0.0, margin_y = 0.0;  // [m] what of the border is mixed with the surroundings

  [[nodiscard]] bool inside(const Vector2& p) const {
    return std::abs(p.x()) < 0.5 * width - margin_x && std::abs(p.y()) < 0.5 * height - margin_y;
  }
  /// Value, slopes and bend at a point of the plane, by the four texels around it.
  [[nodiscard]] Eigen::Vector4d at(const Vector2& p) const {
    const double u = std::clamp((p.x() / width + 0.5) * value.cols - 0.5, 0.0, value.cols - 1.001);
    const double v = std::clamp((p.y() / height + 0.5) * value.rows - 0.5, 0.0, value.rows - 1.001);
    const int i = static_cast<int>(u), j = static_cast<int>(v);
    const double a = u - i, b = v - j;
    const auto mix = [&](const cv::Mat& m) {
      const float* top = m.ptr<float>(j) + i;
      const float* bottom = m.ptr<float>(j + 1) + i;
      return (1.0 - b) * ((1.0 - a) * static_cast<double>(top[0]) + a * static_cast<double>(top[1])) +
             b * ((1.0 - a) * static_cast<double>(bottom[0]) + a * static_cast<double>(bottom[1]));
    };
    return {mix(value), mix(by_x), mix(by_y), mix(bend)};
  }
};

struct State {
  PlanarPose pose;
  double brightness = 0.0, contrast = 1.0;
  double bend = 0.0;  // contrast times half of what is missing in the squared blur [blocks^2]
};

/// Where a ray meets the plane, and the ray, both in the frame of the picture.
struct Meeting {
  Vector2 point;
  Vector3 ray;
};
struct PlaneView {
  Matrix3 back;    // picture from optical
  Vector3 centre;  // of the camera, in the frame of the picture

  explicit PlaneView(const PlanarPose& pose)
      : back(pose.rotation.transpose()), centre(-(pose.rotation.transpose() * pose.translation)) {}
  [[nodiscard]] Meeting meet(const Vector3& ray) const {
    const Vector3 e = back * ray;
    return {centre.head<2>() - e.head<2>() * (centre.z() / e.z()), e};
  }
};

/// Residual of a block and its derivative: a turn and a shift of the picture in its own frame, brightness, contrast,
/// blur.
double residual(const Block& block, const PlaneView& view, const State& state, const Drawing& drawing, Unknowns* by) {
  const Meeting m = view.meet(block.ray);
  const Eigen::Vector4d s = drawing.at(m.point);
  if (by != nullptr) {
    const double x = m.point.x(), y = m.point.y();
    const double gx = state.contrast * s[1], gy = state.contrast * s[2];
    const double along = (gx * m.ray.x() + gy * m.ray.y()) / m.ray.z();
    *by << -gx, -gy, along, along * y, -along * x, gx * y - gy * x, 1.0, s[0], s[3];
  }
  return block.value - state.brightness - state.contrast * s[0] - state.bend * s[3];
}

State moved(const State& state, const Unknowns& step) {
  State s = state;
  s.pose.translation += state.pose.rotation * step.head<3>();
  const double angle = step.segment<3>(3).norm();
  if (angle > 0.0) {
    s.pose.rotation =
        state.pose.rotation * Eigen::AngleAxisd(angle, Vector3(step.segment<3>(3) / angle)).toRotationMatrix();
  }
  s.brightness += step[6];
  s.contrast += step[7];
  s.bend += step[8];
  return s;
}

double huber(double squared_ratio) {
  constexpr double kElbow = 2.0;
  return squared_ratio <= kElbow * kElbow ? 1.0 : kElbow / std::sqrt(squared_ratio);
}

/// The pose with the normal mirrored at the line of sight: the second one that looks the same under weak perspective.
PlanarPose mirrored_tilt(const PlanarPose& pose) {
  const Vector3 sight = pose.translation.normalized(), normal = pose.rotation.col(2);
  const Vector3 mirrored = 2.0 * sight.dot(normal) * sight - normal;
  return {Eigen::Quaterniond::FromTwoVectors(normal, mirrored).toRotationMatrix() * pose.rotation, pose.translation};
}

class Aligner {
 public:
  /// \param size of the picture in the patch [blocks]
  Aligner(const Patch& patch, const PlanarPicture& picture, const models::CameraIntrinsics& camera, const Vector2& size)
      : patch_(patch), picture_(picture), camera_(camera), size_(size) {}

  /// \param both whether to start from the mirrored tilt too: a small picture tilted one way looks nearly as tilted the
  ///        other way
  std::optional<PlanarAlignment> from(const PlanarPose& start, bool both) {
    State state{start, 0.0, 1.0};
    constexpr double kFirstBlur = 1.6;
    draw(kFirstBlur);
    State other{mirrored_tilt(start), 0.0, 1.0};
    const bool settled = settle(state);
    if (both && settle(other) && (!settled || mean_square(other) < mean_square(state))) {
      state = other;
    } else if (!settled) {
      return std::nullopt;
    }

    double best = 0.0, blur = 0.0;
    for (const double candidate : kBlurs) {
      draw(candidate);
      State toned = state;
      if (!tone(toned)) continue;
      const double left = mean_square(toned);
      if (blur > 0.0 && left >= best) break;
      best = left;
      blur = candidate;
    }
    draw(blur);
    if (!(blur > 0.0) || !settle(state)) return std::nullopt;
    auto result = judge(state);
    if (result) result->blur_px = blur;
    return result;
  }

 private:
  /// The picture at the size that it has in the patch, blurred.
  void draw(double blur) {
    const double columns = size_.x(), rows = size_.y();
    drawing_.width = picture_.width;
    drawing_.height = picture_.height;
    const cv::Size size(std::max(8, static_cast<int>(std::lround(columns * kOversampling))),
                        std::max(8, static_cast<int>(std::lround(rows * kOversampling))));
    if (plain_.size() != size) {
      const cv::Mat whole = as_mat(picture_.grey);
      cv::Mat sized;
      const bool shrinks = size.width < whole.cols && size.height < whole.rows;
      cv::resize(whole, sized, size, 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
      sized.convertTo(plain_, CV_32F);
    }
    cv::GaussianBlur(plain_, drawing_.value, {}, blur * kOversampling, 0.0, cv::BORDER_REPLICATE);
    cv::Sobel(drawing_.value, drawing_.by_x, CV_32F, 1, 0, 1, 0.5 * size.width / picture_.width, 0.0,
              cv::BORDER_REPLICATE);
    cv::Sobel(drawing_.value, drawing_.by_y, CV_32F, 0, 1, 1, 0.5 * size.height / picture_.height, 0.0,
              cv::BORDER_REPLICATE);
    cv::Laplacian(drawing_.value, drawing_.bend, CV_32F, 1, kOversampling * kOversampling, 0.0, cv::BORDER_REPLICATE);
    const double border = 2.5 * blur + 0.5;
    drawing_.margin_x = std::min(0.2, border / columns) * picture_.width;
    drawing_.margin_y = std::min(0.2, border / rows) * picture_.height;
  }

  /// The blocks that show the inside of the picture.
  bool choose(const State& state) {
    blocks_.clear();
    const PlaneView view(state.pose);
    const double area = static_cast<double>(patch_.blocks.total());
    const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(0.6 * area / kMost))));
    if (all_.empty()) {
      for (int row = 0; row < patch_.blocks.rows; row += stride) {
        for (int column = 0; column < patch_.blocks.cols; column += stride) {
          if (const auto ray = models::unproject(camera_, patch_.pixel(column, row))) {
            all_.push_back({ray->direction.homogeneous(), static_cast<double>(patch_.blocks.at<float>(row, column)),
                            column / stride, row / stride});
          }
        }
      }
    }
    for (const Block& block : all_) {
      const Meeting m = view.meet(block.ray);
      if (m.ray.z() > 0.05 && drawing_.inside(m.point)) blocks_.push_back(block);
    }
    return blocks_.size() >= static_cast<std::size_t>(kFewest);
  }

  /// Least squares of brightness and contrast alone.
  bool tone(State& state) const {
    double n = 0.0, s = 0.0, ss = 0.0, v = 0.0, sv = 0.0;
    const PlaneView view(state.pose);
    for (const Block& b : blocks_) {
      const double drawn = drawing_.at(view.meet(b.ray).point)[0];
      n += 1.0, s += drawn, ss += drawn * drawn, v += b.value, sv += drawn * b.value;
    }
    const double spread = ss - s * s / n;
    if (!(spread > 1e-6 * n)) return false;
    state.contrast = (sv - s * v / n) / spread;
    state.brightness = (v - state.contrast * s) / n;
    state.bend = 0.0;
    return true;
  }

  [[nodiscard]] double mean_square(const State& state) const {
    const PlaneView view(state.pose);
    double sum = 0.0;
    for (const Block& b : blocks_) {
      const double r = residual(b, view, state, drawing_, nullptr);
      sum += r * r;
    }
    return sum / static_cast<double>(blocks_.size());
  }

  /// Huber's cost with residuals in units of `scale`, and the normal equations about the state.
  double equations(const State& state, double scale, Information& a, Unknowns& b) const {
    const PlaneView view(state.pose);
    a.setZero();
    b.setZero();
    double cost = 0.0;
    Unknowns by;
    for (const Block& block : blocks_) {
      const double r = residual(block, view, state, drawing_, &by);
      const double ratio = r * r / (scale * scale);
      const double w = huber(ratio);
      cost += w < 1.0 ? 4.0 * std::sqrt(ratio) - 4.0 : ratio;
      a.noalias() += (w * by) * by.transpose();
      b += w * r * by;
    }
    return cost;
  }

  bool settle(State& state) { return choose(state) && tone(state) && descend(state); }

  bool descend(State& state) const {
    double scale = std::max(1.0, std::sqrt(mean_square(state)));
    Information a;
    Unknowns b;
    double damping = 1e-4;
    double cost = equations(state, scale, a, b);
    const double distance = state.pose.translation.norm();
    for (int step = 0; step < kSteps; ++step) {
      Information damped = a;
      damped.diagonal() *= 1.0 + damping;
      const Unknowns delta = damped.ldlt().solve(b);
      if (!delta.allFinite()) return false;
      const State next = moved(state, delta);
      Information next_a;
      Unknowns next_b;
      const double next_cost = equations(next, scale, next_a, next_b);
      if (next_cost <= cost) {
        const double gain = cost - next_cost;
        state = next;
        a = next_a;
        b = next_b;
        cost = next_cost;
        damping *= 0.2;
        if (gain < kGain * cost) break;
      } else {
        damping = std::max(1e-3, damping * 10.0);
        if (damping > 1e6) break;
      }
    }
    return state.contrast > 0.0 && state.pose.translation.z() > 0.1 * distance &&
           state.pose.translation.norm() < 3.0 * distance;
  }

  /// Correlation, noise and covariance at the end.
  [[nodiscard]] std::optional<PlanarAlignment> judge(const State& state) const {
    const PlaneView view(state.pose);
    const double n = static_cast<double>(blocks_.size());
    std::vector<double> residuals;
    residuals.reserve(blocks_.size());
    double sum = 0.0, squares = 0.0, left = 0.0;
    for (const Block& b : blocks_) {
      residuals.push_back(residual(b, view, state, drawing_, nullptr));
      sum += b.value, squares += b.value * b.value, left += residuals.back() * residuals.back();
    }
    const double spread = squares - sum * sum / n;
    constexpr double kLeastContrast = 3.0;  // grey levels
    if (!(spread > n * kLeastContrast * kLeastContrast)) return std::nullopt;

    PlanarAlignment result;
    result.pose = state.pose;
    result.pixels = static_cast<int>(blocks_.size());
    result.correlation = std::sqrt(std::max(0.0, 1.0 - left / spread));
    // Rounding to whole grey levels is noise too.
    result.noise = std::sqrt(std::max(left / (n - kUnknowns), 1.0 / 12.0));

    const Together together = go_together(residuals);
    result.structure = together.share * left / spread;
    Information a;
    Unknowns b;
    equations(state, result.noise, a, b);
    const Information inverse = a.ldlt().solve(Information::Identity());
    const auto floor = corner_covariance(state.pose);
    if (!floor) return std::nullopt;
    const Matrix6 own = inverse.topLeftCorner<6, 6>() * (result.noise * result.noise * together.cost) + *floor;
    result.covariance = state.pose.rotation * own.topLeftCorner<3, 3>() * state.pose.rotation.transpose();
    // A tilt t shortens one side by t^2 / 2, which the size, and so the distance, takes up by half: what is unknown of
    // that at second order, Var(t^2 / 4), no Jacobian shows where the picture is seen from the front.
    const double tilts = own(3, 3) * own(3, 3) + own(4, 4) * own(4, 4);
    result.covariance += state.pose.translation * state.pose.translation.transpose() * (tilts / 8.0);
    if (!result.covariance.allFinite() || result.covariance.diagonal().minCoeff() <= 0.0) return std::nullopt;
    return result;
  }

  /// Covariance of shift and turn if each corner were known to kCornerFloor alone: what drawing by interpolation, the
  /// shape of the blur and the rounding of grey levels leave wrong however many pixels there are.
  [[nodiscard]] std::optional<Matrix6> corner_covariance(const PlanarPose& pose) const {
    Matrix6 information = Matrix6::Zero();
    for (const Vector3& corner : picture_.corners()) {
      const auto p = models::project(camera_, pose.rotation * corner + pose.translation);
      if (!p) return std::nullopt;
      Eigen::Matrix<double, 3, 6> moves;
      moves << 1.0, 0.0, 0.0, 0.0, 0.0, -corner.y(), 0.0, 1.0, 0.0, 0.0, 0.0, corner.x(), 0.0, 0.0, 1.0, corner.y(),
          -corner.x(), 0.0;
      const Eigen::Matrix<double, 2, 6> by = p->by_point * pose.rotation * moves;
      information += by.transpose() * by / (kCornerFloor * kCornerFloor);
    }
    return information.ldlt().solve(Matrix6::Identity());
  }

  struct Together {
    double share = 0.0;  // correlation of neighbouring residuals
    double cost = 1.0;   // factor of the covariance
  };
  /// Neighbouring residuals that go together carry less than their number says: (1 + c) / (1 - c) for each direction
  /// of an autoregressive field of order one.
  [[nodiscard]] Together go_together(const std::vector<double>& residuals) const {
    cv::Mat grid(patch_.blocks.rows, patch_.blocks.cols, CV_32S, cv::Scalar(-1));
    for (std::size_t i = 0; i < blocks_.size(); ++i)
      grid.at<int>(blocks_[i].row, blocks_[i].column) = static_cast<int>(i);
    double own = 0.0, across = 0.0, down = 0.0;
    int pairs_across = 0, pairs_down = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const double r = residuals[i];
      own += r * r;
      if (blocks_[i].column > 0) {
        const int j = grid.at<int>(blocks_[i].row, blocks_[i].column - 1);
        if (j >= 0) across += r * residuals[static_cast<std::size_t>(j)], ++pairs_across;
      }
      if (blocks_[i].row > 0) {
        const int j = grid.at<int>(blocks_[i].row - 1, blocks_[i].column);
        if (j >= 0) down += r * residuals[static_cast<std::size_t>(j)], ++pairs_down;
      }
    }
    own /= static_cast<double>(blocks_.size());
    const auto share = [&](double sum, int pairs) {
      return pairs > 0 && own > 0.0 ? std::clamp(sum / pairs / own, 0.0, 0.9) : 0.0;
    };
    const double c = share(across, pairs_across), d = share(down, pairs_down);
    return {std::max(c, d), (1.0 + c) / (1.0 - c) * (1.0 + d) / (1.0 - d)};
  }

  const Patch& patch_;
  const PlanarPicture& picture_;
  const models::CameraIntrinsics& camera_;
  Vector2 size_;
  cv::Mat plain_;
  Drawing drawing_;
  std::vector<Block> all_;     // of the patch
  std::vector<Block> blocks_;  // that show the inside of the picture
};

}  // namespace

std::optional<PlanarAlignment> align_planar(const models::CameraIntrinsics& camera, const Image& grey,
                                            const PlanarPicture& picture, const PlanarPose& start) {
  const auto outline = picture_outline(camera, picture, start);
  if (!outline) return std::nullopt;
  Vector2 low = outline->front(), high = low;
  for (const Vector2& p : *outline) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const auto length = [&](std::size_t i, std::size_t j) { return ((*outline)[i] - (*outline)[j]).norm(); };
  const double columns = 0.5 * (length(0, 1) + length(3, 2)), rows = 0.5 * (length(0, 3) + length(1, 2));
  constexpr double kMargin = 4.0;  // pixels
  const Vector2 limit(grey.width - 1.0, grey.height - 1.0);
  low = (low.array() - kMargin).matrix().cwiseMax(Vector2::Zero()).cwiseMin(limit);
  high = (high.array() + kMargin).matrix().cwiseMin(limit).cwiseMax(Vector2::Zero());
  if (!(columns * rows < 1e8) || !(columns > 4.0) || !(rows > 4.0)) return std::nullopt;

  Patch patch;
  patch.factor = std::max(1, static_cast<int>(std::ceil(std::sqrt(columns * rows) / kLargest - 0.25)));
  patch.first = {static_cast<int>(low.x()), static_cast<int>(low.y())};
  const cv::Size blocks((static_cast<int>(high.x()) + 1 - patch.first.x) / patch.factor,
                        (static_cast<int>(high.y()) + 1 - patch.first.y) / patch.factor);
  if (blocks.width < 8 || blocks.height < 8) return std::nullopt;
  const cv::Rect region(patch.first, cv::Size(blocks.width * patch.factor, blocks.height * patch.factor));
  cv::Mat whole;
  as_mat(grey)(region).convertTo(whole, CV_32F);
  cv::resize(whole, patch.blocks, blocks, 0.0, 0.0, cv::INTER_AREA);

  Aligner aligner(patch, picture, camera, {columns / patch.factor, rows / patch.factor});
  const bool small = columns * rows < kAmbiguous * kAmbiguous;
  auto result = aligner.from(start, small);
  // What is left over goes together from pixel to pixel: the descent ended beside the truth. Others may not.
  for (int k = 0; k < 4 && (!result || result->structure > kStructure); ++k) {
    const Vector3 axis = k / 2 == 0 ? Vector3::UnitX() : Vector3::UnitY();
    PlanarPose tilted = start;
    tilted.rotation = start.rotation * Eigen::AngleAxisd(k % 2 == 0 ? kTilt : -kTilt, axis).toRotationMatrix();
    const auto next = aligner.from(tilted, false);
    if (next && (!result || next->correlation > result->correlation)) result = next;
  }
  if (result) result->blur_px *= patch.factor;
  return result;
}

}  // namespace noctule::sensors
