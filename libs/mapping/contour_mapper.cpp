#include "mapping/contour_mapper.hpp"

#include <algorithm>

namespace noctule::mapping {
namespace {

constexpr double kFirstExtent = 4.0;    // [m]
constexpr int kRestartGrowth = 2;       // echoes heard since the last restart, as a factor
constexpr double kSettleGrowth = 1.25;  // and since the last settling

}  // namespace

ContourMap map_contours(std::span<const PosedScan> scans, const MapperParameters& parameters) {
  ArcReader reader(parameters.range_noise, parameters.stop_distance, parameters.max_noise_scale);
  std::vector<SonarArc> arcs;
  for (const PosedScan& posed : scans) reader.read(posed.scan, posed.base_in_map, arcs);

  Competition competition(parameters, Extent::of(arcs));
  for (std::size_t i = 0; i < arcs.size(); ++i) competition.put(static_cast<int>(i), arcs[i]);
  competition.grow();
  competition.settle();
  ContourMap map = competition.map();
  if (!scans.empty()) map.stamp = scans.back().scan.stamp;
  return map;
}

ContourMapper::ContourMapper(const MapperParameters& parameters)
    : parameters_(parameters),
      reader_(parameters.range_noise, parameters.stop_distance, parameters.max_noise_scale),
      store_(parameters.max_arcs) {}

void ContourMapper::add(const UltrasonicScan& scan, const Pose2& base_in_map) {
  fresh_.clear();
  reader_.read(scan, base_in_map, fresh_);
  stamp_ = scan.stamp;
  if (fresh_.empty()) return;
  if (!competition_) competition_.emplace(parameters_, Extent{fresh_.front().sensor, kFirstExtent});
  for (const SonarArc& arc : fresh_) competition_->put(store_.place(arc), arc);
  heard_ += static_cast<std::int64_t>(fresh_.size());
  competition_->cover();
  competition_->follow();

  const int enough = parameters_.support.min_readings;
  if (heard_ < enough) return;
  bool unsettled = static_cast<double>(heard_) > kSettleGrowth * static_cast<double>(settled_at_);
  if (heard_ > kRestartGrowth * restarted_at_) {
    competition_->restart();
    restarted_at_ = heard_;
    unsettled = true;
    competition_->grow();
    searched_at_ = competition_->unexplained();
  } else if (competition_->unexplained() >= searched_at_ + enough) {
    unsettled |= competition_->grow();
    searched_at_ = competition_->unexplained();
  }
  if (unsettled) {
    competition_->settle();
    settled_at_ = heard_;
    searched_at_ = competition_->unexplained();
  }
}

ContourMap ContourMapper::map() const {
  ContourMap map = competition_ ? competition_->map() : ContourMap{};
  map.stamp = stamp_;
  return map;
}

}  // namespace noctule::mapping
