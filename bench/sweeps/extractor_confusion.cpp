/// Confusion table of the ultrasonic extractor: what one object is taken for after a straight drive past it.
/// Usage: extractor_confusion [trials = 500] [seed = 1]. Prints Markdown.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <string>

#include "statistics/sensors/scene.hpp"

namespace {

using namespace noctule;
using namespace noctule::sensors;
using scene::Kind;

constexpr int kStops = 9;

/// Outcomes in the order of the table's columns; `curved` is type ambiguous with the wall excluded.
enum Outcome { kWall, kArc, kPoint, kCurved, kAmbiguous, kNone, kOutcomes };

struct Cell {
  std::array<int, kOutcomes> count{};
  int nees_samples = 0;
  double nees = 0.0;   ///< sum, per parameter
  double error = 0.0;  ///< sum of the distance error of the surface [m]
};

[[nodiscard]] Outcome outcome(const ContourFeature* f) {
  if (!f || f->stops < 3) return kNone;
  switch (f->type) {
    case ContourType::wall:
      return kWall;
    case ContourType::arc:
      return kArc;
    case ContourType::point:
      return kPoint;
    case ContourType::ambiguous:
      break;
  }
  return f->has_wall ? kAmbiguous : kCurved;
}

/// NEES per parameter of the right kind of surface where the extractor still holds it.
void judge(const scene::Object& object, const Pose2& base, const ContourFeature& f, Cell& cell) {
  const Pose2 base_T_world = inverse(base);
  if (object.kind == Kind::wall && f.has_wall) {
    const Wall truth = transformed(base_T_world, object.wall);
    const Vector2 error(f.wall.rho - truth.rho, wrap(f.wall.theta - truth.theta));
    cell.nees += mahalanobis2<2>(error, f.wall_covariance) / 2.0;
    cell.error += std::abs(error[0]);
    ++cell.nees_samples;
  } else if (object.kind != Kind::wall && f.has_circle) {
    Vector3 error;
    error << f.circle.centre - base_T_world * object.cylinder.centre, f.circle.radius - object.cylinder.radius;
    if (f.type == ContourType::point) {
      if (object.kind == Kind::cylinder) return;
      cell.nees += mahalanobis2<2>(Vector2(error.head<2>()), Matrix2(f.circle_covariance.topLeftCorner<2, 2>())) / 2.0;
    } else {
      cell.nees += mahalanobis2<3>(error, f.circle_covariance) / 3.0;
    }
    cell.error += std::abs(f.circle.distance(Vector2::Zero()) - object.cylinder.distance(base.position()));
    ++cell.nees_samples;
  }
}

Cell run(Kind kind, double range, double scale, double outlier_share, double baseline, int trials, std::uint64_t seed) {
  Cell cell;
  const models::OdometryNoise odometry;
  scene::Ranger ranger;
  ranger.scale = scale;
  ranger.outlier_share = outlier_share;
  for (int trial = 0; trial < trials; ++trial) {
    Rng rng(seed, stream_id("extractor_confusion"), static_cast<std::uint64_t>(trial));
    const scene::Object object = scene::place(kind, range, radians(30.0), rng);
    const scene::Drive drive = scene::drive(object, kStops, baseline, ranger, odometry, rng);
    const auto features = extract(drive.scans, ExtractorParameters{});
    const ContourFeature* best = nullptr;
    for (const ContourFeature& f : features)
      if (!best || f.stops > best->stops) best = &f;
    const Outcome o = outcome(best);
    ++cell.count[o];
    if (o != kNone) judge(object, drive.last, *best, cell);
  }
  return cell;
}

void table(const char* title, double baseline_factor, double outlier_share, std::initializer_list<double> scales,
           int trials, std::uint64_t seed) {
  const models::RangeNoise noise;
  std::printf("\n### %s\n\n", title);
  std::printf(
      "| range m | noise | baseline cm | truth | wall | arc | point | curved | ambiguous | none | wrong | NEES | range "
      "error mm |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const std::array<std::pair<Kind, const char*>, 4> kinds{
      {{Kind::wall, "wall"}, {Kind::cylinder, "cylinder"}, {Kind::corner, "corner"}, {Kind::edge, "edge"}}};
  int wrong = 0, total = 0;
  for (const double range : {0.5, 1.0, 2.0, 3.0}) {
    for (const double scale : scales) {
      const double baseline = baseline_factor * separating_baseline(range, scale * noise.sd(range));
      for (const auto& [kind, name] : kinds) {
        const Cell c = run(kind, range, scale, outlier_share, baseline, trials, seed);
        const auto share = [&](int n) { return 100.0 * n / trials; };
        const int bad = kind == Kind::wall       ? c.count[kArc] + c.count[kPoint] + c.count[kCurved]
                        : kind == Kind::cylinder ? c.count[kWall] + c.count[kPoint]
                                                 : c.count[kWall] + c.count[kArc];
        wrong += bad;
        total += trials;
        std::printf("| %.1f | x%.0f | %.0f | %s |", range, scale, 100.0 * baseline, name);
        for (const int n : c.count) std::printf(" %.1f |", share(n));
        std::printf(" %.1f | %.2f | %.1f |\n", share(bad), c.nees / std::max(1, c.nees_samples),
                    1000.0 * c.error / std::max(1, c.nees_samples));
      }
    }
  }
  std::printf("\nWrong type: %d of %d (%.2f %%).\n", wrong, total, 100.0 * wrong / total);
}

}  // namespace

int main(int argc, char** argv) {
  const int trials = argc > 1 ? std::max(1, std::atoi(argv[1])) : 500;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::printf("%d stops on a straight line, %d drives a row, seed %llu. Shares in per cent; NEES per parameter.\n",
              kStops, trials, static_cast<unsigned long long>(seed));
  table("Sensible baseline: sqrt(12 sqrt(6) sigma r)", 1.0, 0.0, {1.0, 2.0, 4.0}, trials, seed);
  table("Half of it", 0.5, 0.0, {1.0}, trials, seed);
  table("Three times it", 3.0, 0.0, {1.0}, trials, seed);
  table("Sensible baseline, 15 % of the ranges with five times the noise", 1.0, 0.15, {1.0, 4.0}, trials, seed);
}
