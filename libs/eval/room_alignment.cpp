#include "eval/room_alignment.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/assignment.hpp"
#include "eval/statistics.hpp"

namespace noctule::eval {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kLeastSpread = 0.05;  // smallest share of a direction in the walls' normals
constexpr int kRounds = 2;             // of pairing

/// Estimate minus truth, on the branch of (rho, theta) = (-rho, theta + pi) whose normal is nearer to the truth's.
Wall difference(const Wall& estimate, const Wall& truth) {
  const double turn = wrap(estimate.theta - truth.theta);
  if (std::abs(turn) <= 0.5 * kPi) return {estimate.rho - truth.rho, turn};
  return {-estimate.rho - truth.rho, wrap(turn + kPi)};
}

/// Whether the wall stands between the place and a point.
bool between(const RoomWall& w, const Vector2& place, const Vector2& point) {
  const double from = w.wall.distance(place), to = w.wall.distance(point);
  if (from * to >= 0.0) return false;
  const Vector2 crossing = place + from / (from - to) * (point - place);
  const double at = w.wall.tangent().dot(crossing);
  return at > w.begin && at < w.end;
}

bool audible(const Room& room, std::size_t i, const Vector2& place) {
  const RoomWall& w = room.walls[i];
  const double at = w.wall.tangent().dot(place);
  if (at < w.begin || at > w.end) return false;
  const Vector2 foot = place + w.wall.distance(place) * w.wall.normal();
  for (std::size_t j = 0; j < room.walls.size(); ++j) {
    if (j != i && between(room.walls[j], place, foot)) return false;
  }
  return true;
}

std::vector<int> pair_walls(const ContourMap& map, const Room& room, const std::vector<int>& audible, const Pose2& pose,
                            const RoomAlignmentParameters& p) {
  Eigen::MatrixXd costs(audible.size(), map.walls.size());
  for (std::size_t i = 0; i < audible.size(); ++i) {
    const Wall& truth = room.walls[static_cast<std::size_t>(audible[i])].wall;
    for (std::size_t j = 0; j < map.walls.size(); ++j) {
      const Wall d = difference(transformed(pose, map.walls[j].wall), truth);
      const double rho = std::abs(d.rho) / p.rho_gate, theta = std::abs(d.theta) / p.theta_gate;
      costs(i, j) = rho < 1.0 && theta < 1.0 ? rho + theta : kInf;
    }
  }
  return assign(costs, 2.0);
}

using Pairs = std::vector<std::pair<Wall, Wall>>;

/// All pairs but that of wall `left_out` (an index of `match`; -1: none is left out).
Pairs pairs_without(int left_out, const std::vector<int>& match, const ContourMap& map, const Room& room,
                    const std::vector<int>& audible) {
  Pairs pairs;
  for (std::size_t i = 0; i < match.size(); ++i) {
    if (match[i] < 0 || static_cast<int>(i) == left_out) continue;
    pairs.emplace_back(map.walls[static_cast<std::size_t>(match[i])].wall,
                       room.walls[static_cast<std::size_t>(audible[i])].wall);
  }
  return pairs;
}

}  // namespace

std::vector<int> audible_walls(const Room& room, std::span<const Vector2> places) {
  std::vector<int> walls;
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    const bool any =
        std::any_of(places.begin(), places.end(), [&](const Vector2& place) { return audible(room, i, place); });
    if (any) walls.push_back(static_cast<int>(i));
  }
  return walls;
}

std::optional<Pose2> align_walls(std::span<const std::pair<Wall, Wall>> pairs) {
  double sine = 0.0, cosine = 0.0;
  for (const auto& [estimate, truth] : pairs) {
    const double turn = difference(estimate, truth).theta;
    sine += std::sin(turn);
    cosine += std::cos(turn);
  }
  const double yaw = -std::atan2(sine, cosine);
  Matrix2 a = Matrix2::Zero();
  Vector2 b = Vector2::Zero();
  for (const auto& [estimate, truth] : pairs) {
    const Vector2 n = truth.normal();
    a += n * n.transpose();
    b -= n * difference(transformed({0.0, 0.0, yaw}, estimate), truth).rho;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix2> spread(a);
  if (pairs.size() < 2 || spread.eigenvalues()[0] < kLeastSpread * spread.eigenvalues()[1]) return {};
  const Vector2 shift = a.ldlt().solve(b);
  return Pose2{shift.x(), shift.y(), yaw};
}

RoomAlignment align_to_room(const ContourMap& map, const Room& room, std::span<const Vector2> places,
                            const RoomAlignmentParameters& p) {
  if (!(p.rho_gate > 0.0 && p.theta_gate > 0.0)) throw std::invalid_argument("align_to_room: gates must be positive");
  const std::vector<int> audible = audible_walls(room, places);
  RoomAlignment result;
  std::vector<int> match(audible.size(), -1);
  for (int round = 0; round < kRounds && !audible.empty(); ++round) {
    match = pair_walls(map, room, audible, result.room_T_map, p);
    result.room_T_map = align_walls(pairs_without(-1, match, map, room, audible)).value_or(Pose2{});
  }

  std::vector<double> rho, theta;
  for (std::size_t i = 0; i < audible.size(); ++i) {
    const RoomWall& truth = room.walls[static_cast<std::size_t>(audible[i])];
    AlignedWall wall{.name = truth.name, .estimate = match[i]};
    if (match[i] >= 0) {
      ++result.found;
      const auto pose = align_walls(pairs_without(static_cast<int>(i), match, map, room, audible));
      if (pose) {
        const Wall aligned = transformed(*pose, map.walls[static_cast<std::size_t>(match[i])].wall);
        const Wall d = difference(aligned, truth.wall);
        wall.scored = true;
        wall.rho = d.rho;
        wall.theta = d.theta;
        rho.push_back(std::abs(d.rho));
        theta.push_back(std::abs(d.theta));
      }
    }
    result.walls.push_back(wall);
  }
  for (int j = 0; j < static_cast<int>(map.walls.size()); ++j) {
    if (std::find(match.begin(), match.end(), j) == match.end()) result.invented_walls.push_back(j);
  }
  result.scored = static_cast<int>(rho.size());
  result.recall = audible.empty() ? kNan : static_cast<double>(result.found) / static_cast<double>(audible.size());
  result.median_rho = rho.empty() ? kNan : quantile(rho, 0.5);
  result.median_theta = theta.empty() ? kNan : quantile(theta, 0.5);
  return result;
}

}  // namespace noctule::eval
