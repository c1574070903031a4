#include "eval/room_alignment.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "core/assignment.hpp"
#include "core/limits.hpp"
#include "eval/statistics.hpp"

namespace noctule::eval {
namespace {

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

/// The same line seen from a point: rho is the distance from there.
Wall seen_from(const Vector2& point, const Wall& wall) {
  return {wall.distance(point), wall.theta};
}

/// The ranger stands at the origin of estimate and truth. The error of a wall that `pose` brings into the room, seen
/// from where it puts the ranger.
Wall error(const Wall& estimate, const Wall& truth, const Pose2& pose) {
  return difference(seen_from(pose.position(), transformed(pose, estimate)), seen_from(pose.position(), truth));
}

std::vector<int> pair_walls(std::span<const Wall> estimates, std::span<const Wall> truths, const Pose2& pose,
                            const RoomAlignmentParameters& p) {
  Eigen::MatrixXd costs(truths.size(), estimates.size());
  for (std::size_t i = 0; i < truths.size(); ++i) {
    for (std::size_t j = 0; j < estimates.size(); ++j) {
      const Wall d = error(estimates[j], truths[i], pose);
      const double rho = std::abs(d.rho) / p.rho_gate, theta = std::abs(d.theta) / p.theta_gate;
      costs(i, j) = rho < 1.0 && theta < 1.0 ? rho + theta : kInf;
    }
  }
  return assign(costs, 2.0);
}

using WallPairs = std::vector<std::pair<Wall, Wall>>;

/// All pairs but that of wall `left_out`; -1: all.
WallPairs pairs_without(int left_out, const std::vector<int>& match, std::span<const Wall> estimates,
                        std::span<const Wall> truths) {
  WallPairs pairs;
  for (std::size_t i = 0; i < match.size(); ++i) {
    if (match[i] < 0 || static_cast<int>(i) == left_out) continue;
    pairs.emplace_back(estimates[static_cast<std::size_t>(match[i])], truths[i]);
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
  if (places.empty()) throw std::invalid_argument("align_to_room: no place of the ranger");
  const Vector2 ranger = std::accumulate(places.begin(), places.end(), Vector2(Vector2::Zero())) / places.size();
  const std::vector<int> audible = audible_walls(room, places);
  std::vector<Wall> estimates, truths;
  for (const WallEstimate& w : map.walls) estimates.push_back(seen_from(ranger, w.wall));
  for (const int i : audible) truths.push_back(seen_from(ranger, room.walls[static_cast<std::size_t>(i)].wall));

  Pose2 pose;
  std::vector<int> match(truths.size(), -1);
  for (int round = 0; round < kRounds && !truths.empty(); ++round) {
    match = pair_walls(estimates, truths, pose, p);
    pose = align_walls(pairs_without(-1, match, estimates, truths)).value_or(Pose2{});
  }

  RoomAlignment result;
  result.room_T_map = Pose2{ranger.x(), ranger.y(), 0.0} * pose * Pose2{-ranger.x(), -ranger.y(), 0.0};
  std::vector<double> rho, theta;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    AlignedWall& wall = result.walls.emplace_back();
    wall.name = room.walls[static_cast<std::size_t>(audible[i])].name;
    wall.truth = room.walls[static_cast<std::size_t>(audible[i])].wall;
    wall.estimate = match[i];
    if (match[i] < 0) continue;
    ++result.found;
    const auto others = align_walls(pairs_without(static_cast<int>(i), match, estimates, truths));
    if (!others) continue;
    const Wall d = error(estimates[static_cast<std::size_t>(match[i])], truths[i], *others);
    wall.scored = true;
    wall.rho = d.rho;
    wall.theta = d.theta;
    rho.push_back(std::abs(d.rho));
    theta.push_back(std::abs(d.theta));
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

ContourErrors contour_errors(const RoomAlignment& alignment) {
  ContourErrors errors;
  double rho = 0.0, theta = 0.0;
  for (const AlignedWall& w : alignment.walls) {
    const double e_rho = w.scored ? w.rho : kNan, e_theta = w.scored ? w.theta : kNan;
    errors.walls.push_back({w.name, w.truth, false, w.estimate, e_rho, e_theta, e_theta});
    if (!w.scored) continue;
    rho += std::abs(w.rho) / alignment.scored;
    theta += std::abs(w.theta) / alignment.scored;
  }
  if (alignment.scored == 0) rho = theta = kNan;
  errors.all_walls = errors.other_walls = {alignment.found, rho, theta, theta};
  errors.invented_walls = alignment.invented_walls;
  errors.cylinder_mae = errors.cylinder_mae_radius = kNan;
  return errors;
}

}  // namespace noctule::eval
