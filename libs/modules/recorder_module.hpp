#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/source.hpp"
#include "modules/module.hpp"
#include "modules/posed_scans.hpp"
#include "report/run_data.hpp"

namespace noctule::modules {

/// Hears everything and keeps what a report is made of. Publishes nothing but its status.
class RecorderModule : public Module {
 public:
  /// \param world for evaluation
  RecorderModule(bus::Bus& bus, KnownWorld world);

  /// The scans heard so far where the filter says it was, where odometry alone says it was if there is no filter.
  [[nodiscard]] std::vector<mapping::PosedScan> best_posed_scans() const;
  /// What was heard so far, with the figures that follow from it. Title, version, seed and configuration are left to
  /// the caller.
  [[nodiscard]] report::RunData data() const;
  /// Time from the first observation to the latest [s].
  [[nodiscard]] double data_seconds() const { return first_utime_ ? seconds(last_utime_ - *first_utime_) : 0.0; }

 private:
  void listen_to_observations();
  void listen_to_estimates();
  void listen_to_maps();
  void listen_to_modules();
  void see(std::int64_t utime);

  report::RunData data_;
  std::vector<UltrasonicScan> scans_;
  Trajectory truth_{Trajectory::Between::linear};
  Trajectory dead_reckoning_{Trajectory::Between::hold};
  std::map<std::string, module_status> statuses_;  ///< the latest of each module
  std::optional<std::int64_t> first_utime_;
  std::int64_t last_utime_ = 0;
};

}  // namespace noctule::modules
