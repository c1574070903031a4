#pragma once
/// Point objects among false alarms, seen from above: the tracking scene of Vo's toolbox with the figures that the
/// two-stage LMB paper gives (clutter 20 a scan in a square of 2 km, p_D = 0.98, Q = 0.5^2 B B').
#include <string>
#include <vector>

#include "experiment/experiment.hpp"

namespace noctule::experiment {

struct RfsSceneParameters {
  int objects = 10;
  bool moving = true;
  double least_speed = 1.0;        ///< [m/s]
  double greatest_speed = 8.0;     ///< [m/s]
  double acceleration_sd = 0.5;    ///< [m/s^2] of each component, constant within a scan
  double start_half_side = 750.0;  ///< [m] objects start evenly in this square
  double separation = 60.0;        ///< [m] and no nearer to each other
  double half_side = 1000.0;       ///< [m] objects stay in this square, and false alarms lie evenly in it
  int scans = 100;
  double period = 1.0;  ///< [s]
  double detection = 0.98;
  double clutter = 20.0;      ///< mean number of false alarms a scan (Poisson)
  double position_sd = 10.0;  ///< [m] of a measured coordinate

  template <class Visitor>
  static void describe(Visitor& v) {
    using P = RfsSceneParameters;
    v.field("objects", &P::objects, unit::one, "number of objects, all there from the first scan to the last",
            between(0, 1000));
    v.field("moving", &P::moving, unit::one, "false: they stand still");
    v.field("least_speed_m_per_s", &P::least_speed, unit::metre_per_second, "at the start", at_least(0.0));
    v.field("greatest_speed_m_per_s", &P::greatest_speed, unit::metre_per_second, "at the start", at_least(0.0));
    v.field("acceleration_sd_m_per_s2", &P::acceleration_sd, Unit{"m/s^2", 1.0}, "of moving objects", at_least(0.0));
    v.field("start_half_side_m", &P::start_half_side, unit::metre, "objects start evenly in this square", positive());
    v.field("separation_m", &P::separation, unit::metre, "and no nearer to each other", at_least(0.0));
    v.field("half_side_m", &P::half_side, unit::metre, "objects stay, and false alarms lie, in this square",
            positive());
    v.field("scans", &P::scans, unit::one, "number of scans", between(1, 100000));
    v.field("period_s", &P::period, unit::second, "time between scans", positive());
    v.field("detection", &P::detection, unit::one, "probability that an object is seen", between(0.0, 1.0));
    v.field("clutter", &P::clutter, unit::one, "mean number of false alarms in a scan", at_least(0.0));
    v.field("position_sd_m", &P::position_sd, unit::metre, "sd of a measured coordinate", positive());
  }
  [[nodiscard]] std::string validate() const {
    if (greatest_speed < least_speed) return "greatest_speed_m_per_s must not be below least_speed_m_per_s";
    return half_side < start_half_side ? "half_side_m must not be below start_half_side_m" : std::string();
  }
};

/// Filters: `gnn` (global nearest neighbour), `oracle` (Kalman filters that know which object each measurement belongs
/// to, the limit) and `dead_reckoning` (each object stays where it was first measured). Figures are means over the
/// scans: OSPA and its parts (p = 1, c = 100 m), the same from the eleventh scan on (`ospa_settled`), OSPA(2) over
/// windows of 10 scans, GOSPA (p = 1, c = 100 m, alpha = 2), and the error of the number of objects.
class RfsScene : public Scenario {
 public:
  explicit RfsScene(const ScenarioSpec&);
  [[nodiscard]] std::vector<std::string> filters() const override;
  [[nodiscard]] std::vector<std::string> metrics() const override;
  void check(const FilterSpec&) const override;
  [[nodiscard]] std::vector<FilterRun> run(std::uint64_t seed, std::span<const FilterSpec>) const override;

 private:
  RfsSceneParameters parameters_;
};

}  // namespace noctule::experiment
