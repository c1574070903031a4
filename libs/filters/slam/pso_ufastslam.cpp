#include <algorithm>
#include <cmath>

#include "core/chi2.hpp"
#include "core/error.hpp"
#include "core/log_weights.hpp"
#include "filters/slam/ufastslam.hpp"

namespace noctule::filters {

PsoUFastSlam::PsoUFastSlam(const PsoUFastSlamParameters& parameters, std::uint64_t seed, const Pose2& start)
    : UFastSlam(parameters, seed, start),
      weighting_(parameters.weighting),
      when_(parameters.when),
      swarm_(parameters.swarm),
      members_(particles_.size()),
      log_weights_(particles_.size()) {
  if (parameters.optimise != Optimisation::none) {
    throw InputError("PSO-UFastSLAM: optimise: expected none, got apf: the swarm moves the particles already");
  }
}

/// Proposal, weights, resampling, swarm, weights, landmarks: in this order, so that the scan enters each once.
void PsoUFastSlam::observe(const Stamp& stamp) {
  prior_root_ = semidefinite_cholesky<3>(motion_.covariance);
  for_particles([this](std::size_t begin, std::size_t end) { propose(begin, end); });
  particles_.weigh(fits_);
  const auto ancestors = resample();
  if (!ancestors.empty()) inherit(ancestors);
  if (when_ == SwarmMoves::always || !ancestors.empty()) swarm(ancestors.empty());
  points_.make_writable();
  for_particles([this](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) update_landmarks(points_.view(i), particles_.poses()[i]);
  });
  learn_noise();
  motion_ = {};
  live_after_weighing();
  particles_.record(stamp, fits_);
}

void PsoUFastSlam::inherit(std::span<const std::uint32_t> ancestors) {
  points_.inherit(ancestors);
  for (std::size_t i = 0; i < ancestors.size(); ++i) {
    if (ancestors[i] == i) continue;
    members_[i] = members_[ancestors[i]];
    fits_[i] = fits_[ancestors[i]];
  }
}

void PsoUFastSlam::swarm(bool weighed) {
  for_particles([this](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) begin_moves(i);
  });
  for (int k = 0; k < swarm_.iterations; ++k) {
    const Pose2* target = find_target();
    for_particles([this, k, target](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) move(i, k, target);
    });
  }
  for_particles([this](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) settle(i);
  });
  if (weighting_ == SwarmWeighting::equal) return;
  const auto before = particles_.weights().log();
  for (std::size_t i = 0; i < log_weights_.size(); ++i) {
    // Where no resampling has spent it, the weight has the scan's likelihood already.
    if (weighting_ == SwarmWeighting::density && weighed) log_weights_[i] -= fits_[i].log_likelihood;
    log_weights_[i] += before[i];
  }
  if (log_sum_exp(log_weights_) > -kInf) particles_.reweigh(log_weights_);
}

Vector3 PsoUFastSlam::in_prior(const Pose2& motion) const {
  Vector3 rest(motion.x - motion_.mean.x, motion.y - motion_.mean.y, wrap(motion.yaw - motion_.mean.yaw));
  Vector3 place = Vector3::Zero();
  for (int j = 0; j < 3; ++j) {
    if (prior_root_(j, j) > 0.0) place[j] = rest[j] / prior_root_(j, j);
    rest -= place[j] * prior_root_.col(j);
  }
  return place;
}

Pose2 PsoUFastSlam::motion_at(const Vector3& place) const {
  const Vector3 motion = motion_.mean.vector() + prior_root_ * place;
  return {motion[0], motion[1], motion[2]};
}

PsoUFastSlam::Fitness PsoUFastSlam::fitness(std::size_t i, const Vector3& place) {
  const ParticleView seen = points_.view(i);
  const std::size_t known = seen.maps.size(i);
  const Pose2 sensor = sensor_pose(members_[i].before * motion_at(place), seen.scan.sensor_in_base);
  LogDensity density;
  double log_free = 0.0;
  for (std::size_t k = 0; k < seen.slots.size(); ++k) {
    if (!seen.is_known(k, known)) {
      log_free += seen.log_new(k);
      continue;
    }
    const Sighting& z = seen.scan.sightings[k];
    density.multiply(PredictedSighting(seen.landmark(k), z, sensor).s, z);
  }
  const ObservationFit fit = density.fit(log_free);
  return {fit.log_likelihood - 0.5 * place.squaredNorm(), fit.log_likelihood, fit.nis};
}

void PsoUFastSlam::propose(std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    Pose2& pose = particles_.poses()[i];
    members_[i].before = pose;
    members_[i].proposal = posterior(points_.view(i), pose);
    fits_[i] = members_[i].proposal.fit;
    Rng rng = motion_rng(i);
    const Pose2 motion = draw_motion(members_[i].proposal, rng);
    members_[i].place = in_prior(motion);
    pose = pose * motion;
  }
}

void PsoUFastSlam::begin_moves(std::size_t i) {
  Member& m = members_[i];
  m.velocity.setZero();
  m.best = m.place;
  const Matrix3 root = semidefinite_cholesky<3>(m.proposal.covariance);
  for (int j = 0; j < 3; ++j) {
    // A column of the root, in units of the prior: by the same substitution.
    const Vector3 column = motion_.mean.vector() + root.col(j);
    m.spread.col(j) = in_prior({column[0], column[1], column[2]});
  }
  m.reach = 2.0 * m.spread.rowwise().norm();
  const Fitness f = fitness(i, m.place);
  m.density = f.density;
  m.nis = f.nis;
}

/// The best pose of all, where it explains the scan; else none.
const Pose2* PsoUFastSlam::find_target() {
  const auto best = std::ranges::max_element(members_, {}, &Member::density);
  const auto i = static_cast<std::size_t>(best - members_.begin());
  const int dof = fits_[i].degrees_of_freedom;
  if (dof == 0 || !(best->nis < chi2_quantile(swarm_.target_gate, dof))) return nullptr;
  target_ = best->before * motion_at(best->best);
  return &target_;
}

void PsoUFastSlam::move(std::size_t i, int iteration, const Pose2* target) {
  Member& m = members_[i];
  Rng rng(seed_, stream_id("landmark_slam.swarm"),
          particles_.step() * static_cast<std::uint64_t>(swarm_.iterations) + static_cast<std::uint64_t>(iteration),
          static_cast<std::uint32_t>(i));
  const double inertia = swarm_.iterations == 1 ? swarm_.inertia_first
                                                : swarm_.inertia_first + (swarm_.inertia_last - swarm_.inertia_first) *
                                                                             iteration / (swarm_.iterations - 1);
  const Vector3 common = target == nullptr ? m.place : in_prior(between(m.before, *target));
  for (int j = 0; j < 3; ++j) {
    if (!(prior_root_(j, j) > 0.0)) continue;
    const double pull = swarm_.own * rng.uniform() * (m.best[j] - m.place[j]) +
                        swarm_.common * rng.uniform() * (common[j] - m.place[j]);
    m.velocity[j] = std::clamp(inertia * m.velocity[j] + pull, -m.reach[j], m.reach[j]);
    m.place[j] += m.velocity[j];
  }
  const Fitness f = fitness(i, m.place);
  if (f.density > m.density) {
    m.best = m.place;
    m.density = f.density;
    m.nis = f.nis;
  }
}

/// The final pose and the factor of the weight that comes with it.
void PsoUFastSlam::settle(std::size_t i) {
  Member& m = members_[i];
  log_weights_[i] = m.density;
  if (weighting_ == SwarmWeighting::importance) {
    // Drawn about the pose found. Weight or resampling have the likelihood of the scan already, as the proposal knew
    // it.
    Rng rng(seed_, stream_id("landmark_slam.settle"), particles_.step(), static_cast<std::uint32_t>(i));
    double log_proposal = 0.0;
    Vector3 normal;
    for (int j = 0; j < 3; ++j) {
      normal[j] = rng.normal();
      if (m.spread(j, j) > 0.0) log_proposal -= 0.5 * normal[j] * normal[j] + std::log(m.spread(j, j));
    }
    m.best += m.spread * normal;
    log_weights_[i] = fitness(i, m.best).density - log_proposal - m.proposal.fit.log_likelihood;
  }
  particles_.poses()[i] = m.before * motion_at(m.best);
}

}  // namespace noctule::filters
