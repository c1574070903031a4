/// The smoother's covariances against its errors, over independent runs.
#include <gtest/gtest.h>

#include "core/chi2.hpp"
#include "smoothing/landmark_smoother.hpp"
#include "unit/smoothing/small_world.hpp"

namespace noctule::smoothing {
namespace {

constexpr int kRuns = 200;

struct Sums {
  double pose_middle = 0.0;
  double pose_end = 0.0;
  double landmark = 0.0;  ///< one landmark of each run
  double chi2 = 0.0;
  double dof = 0.0;
};

/// \param claimed sd of a sighting as the smoother is told, in units of the true one
Sums run_all(double claimed) {
  Sums sums;
  SmallWorld world;
  world.scans = 30;
  world.landmarks = 8;
  world.sighting_sd = {0.03, radians(0.3)};
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    SmallRun run = drive(world, seed);
    for (Observation& o : run.observations) {
      if (auto* scan = std::get_if<LandmarkDetections>(&o)) {
        for (LandmarkDetection& d : scan->detections) d.covariance *= claimed * claimed;
      }
    }
    LandmarkSmoother smoother({}, world.start);
    feed(smoother, run.observations);
    const SmoothedRun result = smoother.solve();
    EXPECT_TRUE(result.converged);
    const auto pose_nees = [&](std::size_t i) {
      return mahalanobis2<3>(difference(result.path.poses[i].pose, run.truth[i]), result.path_covariances[i]);
    };
    sums.pose_middle += pose_nees(14);
    sums.pose_end += pose_nees(29);
    const LandmarkEstimate& l = result.map.landmarks[seed % result.map.landmarks.size()];
    sums.landmark += mahalanobis2<2>(l.parameters.head<2>() - run.landmarks[static_cast<std::size_t>(l.id)],
                                     Matrix2(l.covariance.topLeftCorner<2, 2>()));
    sums.chi2 += result.chi2;
    sums.dof += result.dof;
  }
  return sums;
}

TEST(LandmarkSmootherConsistency, ErrorsFitTheCovariances) {
  const Sums sums = run_all(1.0);
  const Interval pose = nees_bounds(3, kRuns, 0.999), landmark = nees_bounds(2, kRuns, 0.999);
  EXPECT_GT(sums.pose_middle / kRuns, pose.low);
  EXPECT_LT(sums.pose_middle / kRuns, pose.high);
  EXPECT_GT(sums.pose_end / kRuns, pose.low);
  EXPECT_LT(sums.pose_end / kRuns, pose.high);
  EXPECT_GT(sums.landmark / kRuns, landmark.low);
  EXPECT_LT(sums.landmark / kRuns, landmark.high);
  EXPECT_GT(sums.chi2, chi2_quantile(0.0005, sums.dof));
  EXPECT_LT(sums.chi2, chi2_quantile(0.9995, sums.dof));
}

TEST(LandmarkSmootherConsistency, OverconfidenceIsFound) {
  const Sums sums = run_all(0.5);
  EXPECT_GT(sums.pose_end / kRuns, nees_bounds(3, kRuns, 0.999).high);
  EXPECT_GT(sums.landmark / kRuns, nees_bounds(2, kRuns, 0.999).high);
  EXPECT_GT(sums.chi2, chi2_quantile(0.9995, sums.dof));
}

}  // namespace
}  // namespace noctule::smoothing
