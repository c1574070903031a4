#include "filters/slam/fastslam.hpp"

#include "filters/slam/odometry_proposal.hpp"
#include "filters/slam/particle_kernel.hpp"

namespace noctule::filters {

FastSlam1::FastSlam1(const FastSlam1Parameters& parameters, std::uint64_t seed, const Pose2& start,
                     const OffspringTempering& tempering)
    : LandmarkSlam("FastSLAM 1", parameters, tempering, seed, start), sample_(parameters.sample) {}

void FastSlam1::add_motion(const Odometry& odometry) {
  LandmarkSlam::add_motion(odometry);
  if (sample_ == Sampling::odometry) {
    move({odometry.increment, odometry.covariance}, stream_id("landmark_slam.odometry"), odometry_++);
  }
}

void FastSlam1::before_association() {
  if (sample_ == Sampling::scan) move(motion_, stream_id("landmark_slam.motion"), particles_.step());
  prior_ = motion_;
  motion_ = {};
}

void FastSlam1::move(const PoseGaussian& motion, std::uint64_t stream, std::uint64_t step) {
  const WhitenedMotion whitened(motion);
  for_particles([&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Pose2& pose = particles_.poses()[i];
      pose = whitened.drawn(pose, Rng(seed_, stream, step, static_cast<std::uint32_t>(i)));
    }
  });
}

void FastSlam1::take_in(std::size_t begin, std::size_t end) {
  with_noise([&](const auto& noise) {
    for (std::size_t i = begin; i < end; ++i) {
      fits_[i] = update_map(points_.view(i), particles_.poses()[i], KalmanUpdate{noise});
    }
  });
}

void FastSlam1::propose(std::size_t begin, std::size_t end) {
  with_noise([&](const auto& noise) {
    for (std::size_t i = begin; i < end; ++i) {
      fits_[i] = weigh_pose(points_.view(i), particles_.poses()[i], noise);
    }
  });
}

void FastSlam1::update_maps(std::size_t begin, std::size_t end) {
  with_noise([&](const auto& noise) {
    for (std::size_t i = begin; i < end; ++i) {
      update_map(points_.view(i), particles_.poses()[i], KalmanUpdate{noise});
    }
  });
}

double FastSlam1::log_density_of_motion(std::size_t i, const Pose2& motion) {
  const auto weigh = [&](const auto& noise) { return weigh_pose(points_.view(i), before_[i] * motion, noise); };
  return filters::log_density_of_motion(motion, prior_.mean.vector(), prior_.covariance) +
         with_noise(weigh).log_likelihood;
}

/// The weight is that of one motion.
Pose2 FastSlam1::another_motion(std::size_t i, Rng&) {
  return between(before_[i], particles_.poses()[i]);
}

FastSlam2::FastSlam2(const FastSlam2Parameters& parameters, std::uint64_t seed, const Pose2& start,
                     const OffspringTempering& tempering)
    : LandmarkSlam("FastSLAM 2", parameters, tempering, seed, start), linear_within_(parameters.linear_within) {}

bool FastSlam2::may_wait() const {
  return motion_.covariance(2, 2) < linear_within_ * linear_within_;
}

namespace {

/// Kalman update of the motion by the sightings of known landmarks, one after the other, about the running mean.
template <class Noise>
[[gnu::always_inline]] inline MotionPosterior linear_posterior(const ParticleView& view, const Pose2& before,
                                                               const PoseGaussian& motion, const Noise& noise) {
  MotionPosterior q{motion.mean.vector(), motion.covariance, {}};
  const std::size_t known = view.maps.size(view.particle);
  const Vector2 heading(std::cos(before.yaw), std::sin(before.yaw));
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
    const Pose2 sensor = sensor_pose(base, view.scan.sensor_in_base);
    const PredictedSighting p(m, z, sensor);
    Innovation v = p.v;
    const auto h = by_motion(z, v, heading, sensor.position() - base.position());
    const Eigen::Matrix<double, 3, 2> pht = q.covariance * h.transpose();
    const Matrix2 hph = h * pht;
    const InnovationCovariance stated(p.s.rr + hph(0, 0), p.s.rb + hph(0, 1), p.s.bb + hph(1, 1), v);
    const InnovationCovariance s = weigh(noise, z, v, stated, density);
    if (!(s.distance2 < kInf)) continue;
    Matrix2 inverse, known_pose;
    inverse << s.bb, -s.rb, -s.rb, s.rr;
    const double rb = p.s.rb + (s.rb - stated.rb);
    known_pose << p.s.rr + (s.rr - stated.rr), rb, rb, p.s.bb + (s.bb - stated.bb);
    const Eigen::Matrix<double, 3, 2> gain = pht * (inverse / s.determinant);
    q.mean += gain * Vector2(v.range, v.bearing);
    const Matrix3 a = Matrix3::Identity() - gain * h;
    q.covariance = (a * q.covariance * a.transpose() + gain * known_pose * gain.transpose()).eval();
  }
  q.fit = density.fit(log_free);
  return q;
}

}  // namespace

void FastSlam2::propose(std::size_t begin, std::size_t end) {
  with_noise([&](const auto& noise) {
    for (std::size_t i = begin; i < end; ++i) {
      Pose2& pose = particles_.poses()[i];
      proposals_[i] = linear_posterior(points_.view(i), pose, motion_, noise);
      fits_[i] = proposals_[i].fit;
      Rng rng = motion_rng(i);
      pose = pose * draw_motion(proposals_[i], rng);
    }
  });
}

void FastSlam2::update_maps(std::size_t begin, std::size_t end) {
  with_noise([&](const auto& noise) {
    for (std::size_t i = begin; i < end; ++i) {
      update_map(points_.view(i), particles_.poses()[i], KalmanUpdate{noise});
    }
  });
}

void FastSlam2::take_in(std::size_t begin, std::size_t end) {
  with_noise([&](const auto& noise) {
    for (std::size_t i = begin; i < end; ++i) {
      Pose2& pose = particles_.poses()[i];
      const ParticleView view = points_.view(i);
      const MotionPosterior q = linear_posterior(view, pose, motion_, noise);
      fits_[i] = q.fit;
      Rng rng = motion_rng(i);
      pose = pose * draw_motion(q, rng);
      update_map(view, pose, KalmanUpdate{noise});
    }
  });
}

}  // namespace noctule::filters
