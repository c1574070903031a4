#pragma once
/// All that a simulator yields, sorted by kind.
#include <vector>

#include "sim/simulator.hpp"

namespace noctule::sim::test {

struct Recording {
  std::vector<Odometry> odometry;
  std::vector<GroundTruth> truth;
  std::vector<UltrasonicScan> scans;
  std::vector<Observation> all;  ///< in the order they came

  explicit Recording(Simulator simulator) {
    while (auto observation = simulator.next()) {
      all.push_back(*observation);
      if (const auto* o = std::get_if<Odometry>(&*observation)) odometry.push_back(*o);
      if (const auto* t = std::get_if<GroundTruth>(&*observation)) truth.push_back(*t);
      if (const auto* s = std::get_if<UltrasonicScan>(&*observation)) scans.push_back(*s);
    }
  }
};

}  // namespace noctule::sim::test
