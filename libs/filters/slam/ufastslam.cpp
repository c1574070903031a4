#include "filters/slam/ufastslam.hpp"

#include <array>

#include "core/unscented.hpp"

namespace noctule::filters {
namespace {

/// Sigma points of a prediction (range, bearing), as offsets from the one at the centre. Bearings are differences of
/// directions and need no wrapping.
template <int Columns>
struct Spread {
  std::array<double, 2 * Columns> range, bearing;
};

/// What a sighting does not measure is predicted as it came out.
template <int Columns>
void leave_out(const Sighting& z, Innovation& v, Spread<Columns>& s) {
  if (z.is_whole()) return;
  const bool no_range = z.kind == DetectionKind::bearing_only;
  (no_range ? v.range : v.bearing) = 0.0;
  (no_range ? s.range : s.bearing).fill(0.0);
}

/// Offsets of the points `dx, dy` (from the sensor to the landmark) from the centre's.
template <int Columns>
Spread<Columns> offsets(double cx, double cy, double centre_range, const std::array<double, 2 * Columns>& dx,
                        const std::array<double, 2 * Columns>& dy) {
  Spread<Columns> s;
  std::array<double, 2 * Columns> cross, dot;
  for (std::size_t i = 0; i < 2 * Columns; ++i) {
    s.range[i] = dx[i] * dx[i] + dy[i] * dy[i];
    cross[i] = cx * dy[i] - cy * dx[i];
    dot[i] = cx * dx[i] + cy * dy[i];
  }
  for (std::size_t i = 0; i < 2 * Columns; i += 2) {
    const Pair range = square_root(Pair{s.range[i], s.range[i + 1]});
    s.range[i] = range[0] - centre_range;
    s.range[i + 1] = range[1] - centre_range;
  }
  fast_atan2<2 * Columns>(cross.data(), dot.data(), s.bearing.data());
  return s;
}

/// Mean offset and covariance of a spread.
struct Moments {
  double range = 0.0, bearing = 0.0;
  double rr = 0.0, rb = 0.0, bb = 0.0;
};
template <std::size_t Points>
Moments moments(const std::array<double, Points>& range, const std::array<double, Points>& bearing,
                const UnscentedWeights& w) {
  Moments m;
  for (std::size_t i = 0; i < Points; ++i) {
    m.range += w.other * range[i];
    m.bearing += w.other * bearing[i];
  }
  m.rr = w.covariance_centre * m.range * m.range;
  m.rb = w.covariance_centre * m.range * m.bearing;
  m.bb = w.covariance_centre * m.bearing * m.bearing;
  for (std::size_t i = 0; i < Points; ++i) {
    const double r = range[i] - m.range, b = bearing[i] - m.bearing;
    m.rr += w.other * r * r;
    m.rb += w.other * r * b;
    m.bb += w.other * b * b;
  }
  return m;
}

/// Square root of a landmark's covariance, lower triangular.
struct LandmarkRoot {
  double xx, yx, yy;
  explicit LandmarkRoot(const PointLandmark& m) {
    xx = std::sqrt(std::max(m.xx, 0.0));
    yx = xx > 0.0 ? m.xy / xx : 0.0;
    yy = std::sqrt(std::max(m.yy - yx * yx, 0.0));
  }
};

/// Landmarks by unscented Kalman filters.
template <class Noise>
struct UnscentedUpdate {
  UnscentedWeights w;
  Noise noise;

  UnscentedUpdate(const UnscentedScaling& scaling, const Noise& noise_of_sightings)
      : w(2, scaling), noise(noise_of_sightings) {}

  struct Prediction {
    Innovation v;  ///< of the centre
    LandmarkRoot root;
    Spread<2> spread;
    Moments moments;
  };
  [[nodiscard]] Prediction predict(const PointLandmark& m, const Sighting& z, const Pose2& sensor) const {
    Prediction p{innovation<double>(z, sensor, m.x, m.y), LandmarkRoot(m), {}, {}};
    const double cx = m.x - sensor.x, cy = m.y - sensor.y;
    const double ax = w.spread * p.root.xx, ay = w.spread * p.root.yx, by = w.spread * p.root.yy;
    p.spread =
        offsets<2>(cx, cy, z.range - p.v.range, {cx + ax, cx - ax, cx, cx}, {cy + ay, cy - ay, cy + by, cy - by});
    leave_out(z, p.v, p.spread);
    p.moments = moments(p.spread.range, p.spread.bearing, w);
    return p;
  }

  void update(PointLandmark& m, const Sighting& z, const Pose2& sensor, LogDensity& density) const {
    const Prediction p = predict(m, z, sensor);
    Innovation v = p.v;
    v.range -= p.moments.range;
    v.bearing = wrap(v.bearing - p.moments.bearing);
    const InnovationCovariance stated(p.moments.rr + z.rr, p.moments.rb + z.rb, p.moments.bb + z.bb, v);
    const InnovationCovariance s = weigh(noise, z, v, stated, density);
    const double a = w.other * w.spread * p.root.xx, b = w.other * w.spread * p.root.yx,
                 c = w.other * w.spread * p.root.yy;
    const double first_r = p.spread.range[0] - p.spread.range[1], second_r = p.spread.range[2] - p.spread.range[3];
    const double first_b = p.spread.bearing[0] - p.spread.bearing[1],
                 second_b = p.spread.bearing[2] - p.spread.bearing[3];
    filters::take_in(m, v, {a * first_r, b * first_r + c * second_r, a * first_b, b * first_b + c * second_b}, s);
  }

  /// Sigma points of the sighting, each placed from the sensor.
  [[nodiscard]] PointLandmark start(const Sighting& z, const Pose2& sensor) const {
    PointLandmark m = start_landmark(z, sensor);
    const double rr = std::sqrt(z.rr), br = z.rb / rr, bb = std::sqrt(std::max(z.bb - br * br, 0.0));
    std::array<Vector2, 5> points;
    const auto place = [&](double range, double bearing) -> Vector2 {
      return {sensor.x + range * std::cos(sensor.yaw + bearing), sensor.y + range * std::sin(sensor.yaw + bearing)};
    };
    points[0] = place(z.range, z.bearing);
    points[1] = place(z.range + w.spread * rr, z.bearing + w.spread * br);
    points[2] = place(z.range - w.spread * rr, z.bearing - w.spread * br);
    points[3] = place(z.range, z.bearing + w.spread * bb);
    points[4] = place(z.range, z.bearing - w.spread * bb);
    Vector2 mean;
    Matrix2 covariance;
    unscented_moments<2>(points, w, mean, covariance);
    m.set(mean, covariance);
    return m;
  }
};

/// The proposal: sigma points of motion and landmark (5 dimensions), one landmark after the other.
template <class Noise>
MotionPosterior unscented_posterior(const ParticleView& view, const Pose2& before, const PoseGaussian& motion,
                                    const UnscentedWeights& w, UnscentedVariant variant,
                                    const UnscentedUpdate<Noise>& landmark_update) {
  MotionPosterior q{motion.mean.vector(), motion.covariance, {}};
  const std::size_t known = view.maps.size(view.particle);
  const Pose2& mount = view.scan.sensor_in_base;
  const bool off_centre = mount.x != 0.0 || mount.y != 0.0;
  const double cosine = std::cos(before.yaw), sine = std::sin(before.yaw);
  LogDensity density;
  double log_free = 0.0;
  for (std::size_t k = 0; k < view.slots.size(); ++k) {
    if (!view.is_known(k, known)) {
      log_free += view.log_new(k);
      continue;
    }
    const Sighting& z = view.scan.sightings[k];
    const PointLandmark& m = view.landmark(k);
    const Pose2 base = before * Pose2{q.mean[0], q.mean[1], q.mean[2]};
    const Pose2 sensor = sensor_pose(base, mount);
    const double cx = m.x - sensor.x, cy = m.y - sensor.y;
    const Matrix3 root = semidefinite_cholesky<3>(q.covariance);
    const LandmarkRoot landmark_root(m);

    std::array<double, 10> dx, dy, turn;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t side = 0; side < 2; ++side) {
        const Vector3 step = (side == 0 ? w.spread : -w.spread) * root.col(static_cast<Eigen::Index>(c));
        const std::size_t i = 2 * c + side;
        dx[i] = cx - (cosine * step[0] - sine * step[1]);
        dy[i] = cy - (sine * step[0] + cosine * step[1]);
        turn[i] = step[2];
        if (off_centre && step[2] != 0.0) {  // the sensor swings with the base
          const Vector2 swung = Pose2{0.0, 0.0, base.yaw + step[2]} * mount.position();
          dx[i] -= swung.x() - (sensor.x - base.x);
          dy[i] -= swung.y() - (sensor.y - base.y);
        }
      }
    }
    const bool erb = variant == UnscentedVariant::erb;
    const double ax = erb ? w.spread * landmark_root.xx : 0.0, ay = erb ? w.spread * landmark_root.yx : 0.0,
                 by = erb ? w.spread * landmark_root.yy : 0.0;
    dx[6] = cx + ax, dx[7] = cx - ax, dx[8] = dx[9] = cx;
    dy[6] = cy + ay, dy[7] = cy - ay, dy[8] = cy + by, dy[9] = cy - by;
    turn[6] = turn[7] = turn[8] = turn[9] = 0.0;

    Innovation v = innovation<double>(z, sensor, m.x, m.y);
    Spread<5> spread = offsets<5>(cx, cy, z.range - v.range, dx, dy);
    for (std::size_t i = 0; i < 6; ++i) spread.bearing[i] -= turn[i];
    leave_out(z, v, spread);
    const Moments s = moments(spread.range, spread.bearing, w);
    v.range -= s.range;
    v.bearing = wrap(v.bearing - s.bearing);
    const InnovationCovariance stated(s.rr + z.rr, s.rb + z.rb, s.bb + z.bb, v);
    Moments l;  // of what the weight knows and the proposal does not (eq. 24, 25)
    if (!erb) {
      l = landmark_update.predict(m, z, sensor).moments;
    }
    const InnovationCovariance weighed(stated.rr + l.rr, stated.rb + l.rb, stated.bb + l.bb, v);
    const InnovationCovariance believed = weigh(landmark_update.noise, z, v, weighed, density);
    const InnovationCovariance gain_s(stated.rr + (believed.rr - weighed.rr), stated.rb + (believed.rb - weighed.rb),
                                      stated.bb + (believed.bb - weighed.bb), v);
    if (!(gain_s.distance2 < kInf)) continue;

    Eigen::Matrix<double, 3, 2> cross = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector2 difference(spread.range[2 * c] - spread.range[2 * c + 1],
                               spread.bearing[2 * c] - spread.bearing[2 * c + 1]);
      cross += w.other * w.spread * root.col(static_cast<Eigen::Index>(c)) * difference.transpose();
    }
    Matrix2 inverse;
    inverse << gain_s.bb, -gain_s.rb, -gain_s.rb, gain_s.rr;
    const Eigen::Matrix<double, 3, 2> gain = cross * (inverse / gain_s.determinant);
    q.mean += gain * Vector2(v.range, v.bearing);
    q.covariance -= gain * cross.transpose();
    symmetrise(q.covariance);
  }
  q.fit = density.fit(log_free);
  return q;
}

}  // namespace

UFastSlam::UFastSlam(const UFastSlamParameters& parameters, std::uint64_t seed, const Pose2& start,
                     const OffspringTempering& tempering)
    : LandmarkSlam("UFastSLAM", parameters, tempering, seed, start),
      variant_(parameters.variant),
      scaling_(parameters.scaling),
      linear_within_(parameters.linear_within) {}

/// Unscented transform of motion * increment, six dimensions.
void UFastSlam::add_motion(const Odometry& odometry) {
  const UnscentedWeights w(6, scaling_);
  const auto first = sigma_points<3>(motion_.mean.vector(), semidefinite_cholesky<3>(motion_.covariance), w.spread);
  const auto second =
      sigma_points<3>(odometry.increment.vector(), semidefinite_cholesky<3>(odometry.covariance), w.spread);
  std::array<Vector3, 13> points;
  for (std::size_t i = 0; i < 13; ++i) {
    const Vector3 &a = first[i < 7 ? i : 0], &b = second[i < 7 ? 0 : i - 6];
    points[i] << a[0] + std::cos(a[2]) * b[0] - std::sin(a[2]) * b[1],
        a[1] + std::sin(a[2]) * b[0] + std::cos(a[2]) * b[1], a[2] + b[2];
  }
  Vector3 mean;
  unscented_moments<3>(points, w, mean, motion_.covariance);
  motion_.mean = {mean[0], mean[1], mean[2]};  // not wrapped: sums of turns stay sums
}

bool UFastSlam::may_wait() const {
  return motion_.covariance(2, 2) < linear_within_ * linear_within_;
}

MotionPosterior UFastSlam::posterior(const ParticleView& view, const Pose2& before) {
  return with_noise([&](const auto& noise) {
    return unscented_posterior(view, before, motion_, UnscentedWeights(5, scaling_), variant_,
                               UnscentedUpdate(scaling_, noise));
  });
}

void UFastSlam::update_landmarks(const ParticleView& view, const Pose2& pose) {
  with_noise([&](const auto& noise) { update_map(view, pose, UnscentedUpdate(scaling_, noise)); });
}

void UFastSlam::take_in(std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    Pose2& pose = particles_.poses()[i];
    const MotionPosterior q = posterior(points_.view(i), pose);
    fits_[i] = q.fit;
    Rng rng = motion_rng(i);
    pose = pose * draw_motion(q, rng);
    update_landmarks(points_.view(i), pose);
  }
}

void UFastSlam::propose(std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    Pose2& pose = particles_.poses()[i];
    proposals_[i] = posterior(points_.view(i), pose);
    fits_[i] = proposals_[i].fit;
    Rng rng = motion_rng(i);
    pose = pose * draw_motion(proposals_[i], rng);
  }
}

void UFastSlam::update_maps(std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) update_landmarks(points_.view(i), particles_.poses()[i]);
}

}  // namespace noctule::filters
