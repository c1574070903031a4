#include "eval/corridor.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace noctule::eval {
namespace {

constexpr double kStep = 0.05;            // positions nearer to each other than this count once [m]
constexpr std::size_t kFewestInLeg = 10;  // positions

struct Leg {
  Vector2 middle = Vector2::Zero();
  Vector2 direction = Vector2::UnitX();
  double half_length = 0.0;  ///< [m]
};

/// Sums of positions and of their products: the line through any piece of the way without going through it again.
struct Moments {
  double n = 0.0;
  Vector2 sum = Vector2::Zero();
  Matrix2 square = Matrix2::Zero();

  void add(const Vector2& p) {
    n += 1.0;
    sum += p;
    square += p * p.transpose();
  }
  friend Moments operator-(const Moments& a, const Moments& b) {
    return {a.n - b.n, a.sum - b.sum, a.square - b.square};
  }
  [[nodiscard]] Eigen::SelfAdjointEigenSolver<Matrix2> axes() const {
    return Eigen::SelfAdjointEigenSolver<Matrix2>(Matrix2(square - sum * sum.transpose() / n));
  }
};

std::vector<Vector2> without_standstill(std::span<const Vector2> positions) {
  std::vector<Vector2> kept;
  for (const Vector2& p : positions) {
    if (kept.empty() || (p - kept.back()).norm() >= kStep) kept.push_back(p);
  }
  return kept;
}

std::size_t turning_point(const std::vector<Vector2>& way) {
  std::vector<Moments> until(1);
  for (const Vector2& p : way) {
    until.push_back(until.back());
    until.back().add(p);
  }
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = kFewestInLeg; i + kFewestInLeg <= way.size(); ++i) {
    const double sum = until[i].axes().eigenvalues()[0] + (until.back() - until[i]).axes().eigenvalues()[0];
    if (sum >= least) continue;
    least = sum;
    best = i;
  }
  return best;
}

Leg leg_of(std::span<const Vector2> way) {
  Moments moments;
  for (const Vector2& p : way) moments.add(p);
  Leg leg;
  leg.direction = moments.axes().eigenvectors().col(1);
  if (leg.direction.dot(way.back() - way.front()) < 0.0) leg.direction = -leg.direction;
  const Vector2 centre = moments.sum / moments.n;
  const double from = leg.direction.dot(way.front() - centre), to = leg.direction.dot(way.back() - centre);
  leg.middle = centre + 0.5 * (from + to) * leg.direction;
  leg.half_length = 0.5 * std::abs(to - from);
  return leg;
}

/// The wall with its normal on the side of `normal`, whatever the sign of rho.
Wall turned_towards(const Wall& wall, const Vector2& normal) {
  if (wall.normal().dot(normal) >= 0.0) return wall;
  return {-wall.rho, wrap(wall.theta + kPi)};
}

/// The wall of a leg, on the side that `normal` points to, that most echoes speak for; of equal ones the first.
int best_supported(const ContourMap& map, const Leg& leg, const Vector2& normal, const CorridorParameters& p) {
  int best = -1, readings = 0;
  for (int j = 0; j < static_cast<int>(map.walls.size()); ++j) {
    const WallEstimate& w = map.walls[static_cast<std::size_t>(j)];
    const Wall wall = turned_towards(w.wall, normal);
    const double distance = wall.distance(leg.middle);
    if (wall.normal().dot(normal) < std::cos(p.alignment) || !(distance > 0.0 && distance < p.reach)) continue;
    const Vector2 middle = w.wall.rho * w.wall.normal() + 0.5 * (w.begin + w.end) * w.wall.tangent();
    const bool beside = std::abs(leg.direction.dot(middle - leg.middle)) < leg.half_length + p.margin;
    if (!beside || w.readings <= readings) continue;
    readings = w.readings;
    best = j;
  }
  return best;
}

}  // namespace

CorridorFigures corridor_figures(const ContourMap& map, std::span<const Vector2> positions,
                                 const CorridorParameters& p) {
  if (!p.valid()) throw std::invalid_argument("corridor_figures: parameters must be positive");
  CorridorFigures figures;
  const std::vector<Vector2> way = without_standstill(positions);
  const std::size_t turn = turning_point(way);
  if (turn == 0) return figures;
  const Leg first = leg_of(std::span(way).first(turn)), second = leg_of(std::span(way).subspan(turn));
  const auto left_of = [](const Leg& leg) { return Vector2(-leg.direction.y(), leg.direction.x()); };
  const auto wall = [&](int j, const Vector2& normal) {
    return turned_towards(map.walls[static_cast<std::size_t>(j)].wall, normal);
  };

  const Vector2 left = left_of(first);
  figures.left = best_supported(map, first, left, p);
  figures.right = best_supported(map, first, -left, p);
  if (figures.left < 0 || figures.right < 0) return figures;
  const Wall l = wall(figures.left, left), r = wall(figures.right, -left);
  figures.width = l.distance(first.middle) + r.distance(first.middle);
  figures.parallelism = wrap(l.theta - r.theta - kPi);
  const double mean_theta = r.theta + kPi + 0.5 * *figures.parallelism;  // of the left normal

  const Vector2 left2 = left_of(second);
  const int a = best_supported(map, second, left2, p), b = best_supported(map, second, -left2, p);
  const auto theta_variance = [&](int j) {
    return j < 0 ? std::numeric_limits<double>::infinity() : map.walls[static_cast<std::size_t>(j)].covariance(1, 1);
  };
  figures.second = theta_variance(a) <= theta_variance(b) ? a : b;
  if (figures.second >= 0) figures.corner = std::abs(wrap(wall(figures.second, left2).theta - mean_theta));
  return figures;
}

}  // namespace noctule::eval
