#include "sensors/ultrasonic/extractor.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/assignment.hpp"
#include "core/check.hpp"
#include "core/chi2.hpp"
#include "core/error.hpp"
#include "core/gaussian.hpp"
#include "core/limits.hpp"
#include "core/log_weights.hpp"
#include "models/ultrasonic.hpp"

namespace noctule::sensors {
namespace {

constexpr std::size_t kMaxReadings = 64;  ///< that are fused into one sighting while the robot stands
constexpr int kScaleLag = 4;              ///< scans that the noise scale needs to follow a jump
constexpr double kGoodFit = 0.05;         ///< probability of chi2 above which a decided surface is not questioned
constexpr double kAmpleBaseline = 1.5;    ///< in units of the separating one: from here on old sightings may go

[[nodiscard]] std::vector<ReadingId> readings_of(const DepthRegion& region, std::int64_t scan_seq) {
  std::vector<ReadingId> readings;
  readings.reserve(region.beams.size());
  for (const std::int32_t beam : region.beams) readings.push_back({scan_seq, beam});
  return readings;
}

/// Range that a sighting would have had at another position near by, its echo coming along the same direction.
[[nodiscard]] double range_at(const Sighting& s, const Vector2& position) {
  return s.range + Vector2(std::cos(s.direction), std::sin(s.direction)).dot(s.position - position);
}

/// Innovation of a sighting from a predicted surface: squared distance and log density.
struct Innovation {
  double distance2 = kInf;
  double log_density = -kInf;
};
template <int D>
[[nodiscard]] Innovation innovation(const Sighting& s, const models::EchoPrediction<D>& echo,
                                    const MatrixD<D>& covariance) {
  Eigen::Matrix<double, 2, D> h;
  h << echo.range_by_feature, echo.direction_by_feature;
  Matrix2 total = h * covariance * h.transpose();
  total(0, 0) += s.range_variance;
  total(1, 1) += s.direction_variance + s.direction_bias_variance;
  const Vector2 off(s.range - echo.range, wrap(s.direction - echo.direction));
  const auto llt = cholesky<2>(total);
  return {llt.matrixL().solve(off).squaredNorm(), log_gaussian<2>(off, llt)};
}

void apply(const FrameChange& change, SurfaceFits& fits) {
  if (fits.wall) {
    Wall wall{fits.wall->parameters[0], fits.wall->parameters[1]};
    change.apply(wall, fits.wall->covariance);
    fits.wall->parameters = {wall.rho, wall.theta};
  }
  if (fits.point) change.apply(fits.point->parameters, fits.point->covariance);
  if (fits.cylinder) {
    Cylinder cylinder{fits.cylinder->parameters.head<2>(), fits.cylinder->parameters[2]};
    change.apply(cylinder, fits.cylinder->covariance);
    fits.cylinder->parameters << cylinder.centre, cylinder.radius;
  }
}

[[nodiscard]] double probability(const Decision& decision, ContourType type) {
  switch (type) {
    case ContourType::wall:
      return decision.wall;
    case ContourType::point:
      return (1.0 - decision.wall) * decision.small;
    case ContourType::arc:
      return (1.0 - decision.wall) * (1.0 - decision.small);
    case ContourType::ambiguous:
      break;
  }
  return 0.0;
}

/// Sensor positions that are farther apart than `same_place`.
[[nodiscard]] int distinct_positions(std::span<const Sighting> sightings, double same_place) {
  int count = 0;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const auto seen = [&](const Sighting& s) { return (s.position - sightings[i].position).norm() < same_place; };
    if (std::none_of(sightings.begin(), sightings.begin() + static_cast<std::ptrdiff_t>(i), seen)) ++count;
  }
  return count;
}

void check(const Odometry& odometry) {
  const bool sound = odometry.increment.finite() && odometry.covariance.allFinite() &&
                     (odometry.covariance.diagonal().array() >= 0.0).all();
  if (!sound)
    throw InputError("odometry " + std::to_string(odometry.stamp.seq) +
                     ": expected a finite increment and a covariance with variances >= 0, got something else");
}

[[nodiscard]] bool after(const Stamp& a, const Stamp& b) {
  return a.seq > b.seq && a.utime > b.utime;
}

}  // namespace

UltrasonicExtractor::UltrasonicExtractor(const ExtractorParameters& parameters)
    : parameters_((require_sound(parameters, "ultrasonic extractor"), parameters)),
      gate_(chi2_quantile(parameters.gate, 2)),
      finder_(parameters.regions) {}

ExtractorCounts UltrasonicExtractor::counts() const {
  ExtractorCounts counts = counts_;
  counts.beams = finder_.ignored_beams();
  return counts;
}

void UltrasonicExtractor::predict(const Odometry& odometry) {
  check(odometry);
  if (has_odometry_) {
    if (odometry.stamp.seq <= last_odometry_.seq || odometry.stamp.utime < last_odometry_.utime) {
      ++counts_.odometry;
      return;
    }
    if (odometry.stamp.seq > last_odometry_.seq + 1) {
      ++counts_.odometry_gaps;
      tracks_.clear();
    }
  }
  has_odometry_ = true;
  last_odometry_ = odometry.stamp;
  pending_ = pending_ * PoseGaussian{odometry.increment, odometry.covariance};
}

ContourFeatures UltrasonicExtractor::update(const UltrasonicScan& scan) {
  ContourFeatures result{scan.stamp, {}};
  if (has_scan_ && !after(scan.stamp, last_scan_)) {
    ++counts_.scans;
    return result;
  }
  const std::vector<DepthRegion>& regions = finder_.find(scan);
  has_scan_ = true;
  last_scan_ = scan.stamp;
  move(FrameChange(pending_));
  pending_ = {};
  associate(scan, regions);
  for (Track& track : tracks_) {
    if (track.unseen > 0) continue;
    refit(track);
    result.features.push_back(feature(track));
  }
  return result;
}

void UltrasonicExtractor::move(const FrameChange& change) {
  std::erase_if(tracks_, [&](const Track& track) { return track.unseen >= parameters_.patience; });
  for (Track& track : tracks_) {
    ++track.unseen;
    for (Sighting& s : track.sightings) change.apply(s);
    apply(change, track.fits);
    distrust_recent(track);
  }
}

/// The estimate of the noise lags behind the noise: sightings of the last few scans are believed no better than it
/// says now.
void UltrasonicExtractor::distrust_recent(Track& track) const {
  for (std::size_t i = 0; i < track.sources.size(); ++i) {
    Source& source = track.sources[i];
    if (++source.age > kScaleLag || source.noise_scale >= noise_scale()) continue;
    const double grown = noise_scale() / source.noise_scale;
    track.sightings[i].range_variance *= grown * grown;
    source.noise_scale = noise_scale();
  }
}

/// -log p(sighting | track), infinite outside the gate. The kinds of surface count by their probability.
double UltrasonicExtractor::cost(const Track& track, const Sighting& sighting) const {
  double nearest = kInf, density = 0.0;
  const auto count = [&](const Innovation& i, double probability) {
    if (probability < 1.0 - parameters_.decision.certainty) return;
    nearest = std::min(nearest, i.distance2);
    density += probability * std::exp(i.log_density);
  };
  const SurfaceFits& fits = track.fits;
  if (fits.wall) {
    const Wall wall{fits.wall->parameters[0], fits.wall->parameters[1]};
    count(innovation<2>(sighting, models::predict_echo(sighting.position, wall), fits.wall->covariance),
          track.decision.wall);
  }
  if (fits.cylinder) {
    const Cylinder cylinder{fits.cylinder->parameters.head<2>(), fits.cylinder->parameters[2]};
    count(innovation<3>(sighting, models::predict_echo(sighting.position, cylinder), fits.cylinder->covariance),
          track.decision.cylinder);
  }
  if (fits.point) {
    const Cylinder point{fits.point->parameters, 0.0};
    Matrix3 covariance = Matrix3::Zero();
    covariance.topLeftCorner<2, 2>() = fits.point->covariance;
    count(innovation<3>(sighting, models::predict_echo(sighting.position, point), covariance), track.decision.point);
  }
  return nearest < gate_ ? -std::log(density) : kInf;
}

/// Each region joins at most one track and each track takes its best region; a region that is left over although it
/// fits a track (one object heard as two runs) joins it too; all others start tracks.
void UltrasonicExtractor::associate(const UltrasonicScan& scan, const std::vector<DepthRegion>& regions) {
  const auto rows = static_cast<Eigen::Index>(regions.size()), columns = static_cast<Eigen::Index>(tracks_.size());
  const double cost_of_new = std::log(scan.max_range * kTwoPi);  // a new object may be anywhere
  Eigen::MatrixXd costs(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < columns; ++j)
      costs(i, j) = cost(tracks_[static_cast<std::size_t>(j)], regions[static_cast<std::size_t>(i)].heard);
  std::vector<int> track_of(regions.size(), -1);
  if (rows > 0 && columns > 0) track_of = assign(costs, cost_of_new);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    if (track_of[i] < 0 && columns > 0) {
      Eigen::Index nearest = 0;
      const double least = costs.row(static_cast<Eigen::Index>(i)).minCoeff(&nearest);
      if (least < cost_of_new) track_of[i] = static_cast<int>(nearest);
    }
    const Sighting& sighting = regions[i].heard;
    Source source{readings_of(regions[i], scan.stamp.seq), noise_scale(), 0};
    if (track_of[i] < 0 && static_cast<int>(source.readings.size()) < parameters_.min_readings) continue;
    if (track_of[i] < 0)
      start_track(sighting, std::move(source));
    else
      add(tracks_[static_cast<std::size_t>(track_of[i])], sighting, std::move(source));
  }
}

void UltrasonicExtractor::start_track(const Sighting& sighting, Source source) {
  Track& track = tracks_.emplace_back();
  track.number = next_number_++;
  track.sightings.push_back(sighting);
  track.sources.push_back(std::move(source));
}

/// A sighting from the place of the latest one is fused with it (as long as the odometry between them is better than
/// the readings): the place counts once.
void UltrasonicExtractor::add(Track& track, const Sighting& sighting, Source source) const {
  track.unseen = 0;
  Sighting& latest = track.sightings.back();
  const Vector2 u(std::cos(latest.direction), std::sin(latest.direction));
  const Eigen::RowVector3d twist(u.x(), u.y(), u.y() * latest.position.x() - u.x() * latest.position.y());
  const bool same_place = (sighting.position - latest.position).norm() < parameters_.same_place &&
                          twist * latest.drift * twist.transpose() < sighting.range_variance &&
                          latest.drift(2, 2) < sighting.direction_variance;
  if (!same_place) {
    track.sightings.push_back(sighting);
    track.sources.push_back(std::move(source));
    thin(track);
    return;
  }
  Source& fused = track.sources.back();
  if (fused.readings.size() + source.readings.size() > kMaxReadings) {  // enough: the newest replace the oldest
    latest = sighting;
    fused = std::move(source);
    return;
  }
  const double w = latest.range_variance / (latest.range_variance + sighting.range_variance);
  const double v = latest.direction_variance / (latest.direction_variance + sighting.direction_variance);
  latest.range += w * (range_at(sighting, latest.position) - latest.range);
  latest.range_variance *= 1.0 - w;
  latest.direction = wrap(latest.direction + v * wrap(sighting.direction - latest.direction));
  latest.direction_variance *= 1.0 - v;
  fused.readings.insert(fused.readings.end(), source.readings.begin(), source.readings.end());
  fused.noise_scale = std::max(fused.noise_scale, source.noise_scale);
  fused.age = 0;
}

/// Makes room in a full window: the oldest sighting goes once the others span an ample baseline for the range and the
/// noise, else the one that stands closest between its neighbours.
void UltrasonicExtractor::thin(Track& track) const {
  if (static_cast<int>(track.sightings.size()) <= parameters_.window) return;
  const auto& s = track.sightings;
  const double sigma = noise_scale() * parameters_.regions.noise.sd(s.back().range);
  std::size_t goes = 0;
  if (baseline(std::span(s).subspan(1)) < kAmpleBaseline * separating_baseline(s.back().range, sigma)) {
    double least = kInf;
    for (std::size_t i = 1; i + 2 < s.size(); ++i) {
      const double gap = (s[i + 1].position - s[i - 1].position).norm();
      if (gap >= least) continue;
      least = gap;
      goes = i;
    }
  }
  track.sightings.erase(track.sightings.begin() + static_cast<std::ptrdiff_t>(goes));
  track.sources.erase(track.sources.begin() + static_cast<std::ptrdiff_t>(goes));
}

void UltrasonicExtractor::refit(Track& track) {
  if (still_fits(track)) return;
  const DecisionParameters& p = parameters_.decision;
  const auto evaluate = [&] {
    track.fits = fit_surfaces(track.sightings, p, track.fits);
    return decide(track.fits, distinct_positions(track.sightings, parameters_.same_place), p);
  };
  Decision decision = evaluate();
  if (!decision.explained && track.sightings.size() > 1) {  // wrong grouping: what this scan heard starts again
    track.number = next_number_++;
    while (track.sightings.size() > 1 && track.sources.front().readings.back().scan_seq != last_scan_.seq) {
      track.sightings.erase(track.sightings.begin());
      track.sources.erase(track.sources.begin());
    }
    track.fits = {};
    track.decision = {};
    decision = evaluate();
  }
  // What was decided stays, unless the evidence now speaks against it.
  const ContourType before = track.decision.type;
  if (decision.type == ContourType::ambiguous && probability(decision, before) > 1.0 - p.certainty)
    decision.type = before;
  track.decision = decision;
}

/// Fits a decided track as what it was decided to be. As long as that fits well the other surfaces are not asked.
bool UltrasonicExtractor::still_fits(Track& track) const {
  const ContourType type = track.decision.type;
  if (type == ContourType::ambiguous) return false;
  const Kinds kind{type == ContourType::wall, type == ContourType::point, type == ContourType::arc};
  const SurfaceFits fits = fit_surfaces(track.sightings, parameters_.decision, track.fits, kind);
  const auto good = [](const auto& fit) { return fit && !improbable(*fit, kGoodFit); };
  if (!(kind.wall ? good(fits.wall) : kind.point ? good(fits.point) : good(fits.cylinder))) return false;
  track.fits = fits;
  return true;
}

ContourFeature UltrasonicExtractor::feature(const Track& track) const {
  ContourFeature f;
  const SurfaceFits& fits = track.fits;
  const Decision& d = track.decision;
  const double open = 1.0 - parameters_.decision.certainty;
  f.type = d.type;
  f.track = track.number;
  f.stops = distinct_positions(track.sightings, parameters_.same_place);
  f.baseline = baseline(track.sightings);
  for (const Source& source : track.sources)
    f.readings.insert(f.readings.end(), source.readings.begin(), source.readings.end());

  const bool undecided = d.type == ContourType::ambiguous;
  if (fits.wall && (d.type == ContourType::wall || (undecided && d.wall > open))) {
    f.has_wall = true;
    f.wall = {fits.wall->parameters[0], fits.wall->parameters[1]};
    f.wall_covariance = fits.wall->covariance;
    f.wall_log_likelihood = fits.wall->log_evidence;
  }
  if (fits.point && d.type == ContourType::point) {
    f.has_circle = true;
    f.circle = {fits.point->parameters, 0.0};
    f.circle_covariance.topLeftCorner<2, 2>() = fits.point->covariance;
    f.circle_log_likelihood = fits.point->log_evidence;
  } else if (fits.cylinder && (d.type == ContourType::arc || (undecided && 1.0 - d.wall > open))) {
    const Vector3& x = fits.cylinder->parameters;
    f.has_circle = true;
    f.circle = {x.head<2>(), x[2]};
    if (x[2] < 0.0) f.circle = {fits.point ? fits.point->parameters : Vector2(x.head<2>()), 0.0};
    f.circle_covariance = fits.cylinder->covariance;
    f.circle_log_likelihood = fits.cylinder->log_evidence;
    if (undecided && fits.point)
      f.circle_log_likelihood = log_add_exp(f.circle_log_likelihood, fits.point->log_evidence) - std::log(2.0);
  }
  const Sighting& latest = track.sightings.back();
  f.surface = latest.position + latest.range * Vector2(std::cos(latest.direction), std::sin(latest.direction));
  if (f.has_wall && (!f.has_circle || d.wall >= 0.5))
    f.surface = f.wall.rho * f.wall.normal();
  else if (f.has_circle)
    f.surface = f.circle.centre * (1.0 - f.circle.radius / std::max(f.circle.centre.norm(), f.circle.radius));
  return f;
}

std::vector<ContourFeature> extract(std::span<const MovedScan> scans, const ExtractorParameters& parameters) {
  UltrasonicExtractor extractor(parameters);
  std::map<std::int64_t, ContourFeature> latest;
  std::int64_t step = 0;
  for (const MovedScan& moved : scans) {
    if (step > 0) {
      extractor.predict({{step, step}, moved.motion.mean, moved.motion.covariance});
      const FrameChange change(moved.motion);
      for (auto& [track, feature] : latest) change.apply(feature);
    }
    ++step;
    for (ContourFeature& feature : extractor.update(moved.scan).features)
      latest.insert_or_assign(feature.track, std::move(feature));
  }
  std::vector<ContourFeature> features;
  features.reserve(latest.size());
  for (auto& [track, feature] : latest) features.push_back(std::move(feature));
  return features;
}

}  // namespace noctule::sensors
