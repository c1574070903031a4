#pragma once
/// Where observations come from: a simulator, a recorded data set, a log. Knows no filter, no clock, no bus.
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/contour.hpp"
#include "core/image.hpp"
#include "core/observations.hpp"

namespace noctule {

using Observation = std::variant<Odometry, UltrasonicScan, LandmarkDetections, GroundTruth, CameraImage>;

struct KnownLandmark {
  std::int64_t id = 0;
  Vector2 position = Vector2::Zero();  ///< map frame [m]
};

/// Where the base was at a time, by a receiver that knows no heading.
struct KnownPosition {
  std::int64_t utime = 0;
  Vector2 position = Vector2::Zero();  ///< map frame [m]
};

/// What is known about the world beside the stream itself; for evaluation only, no filter sees it.
struct KnownWorld {
  std::string name;
  std::optional<Room> room;              ///< contours, map frame
  std::vector<KnownLandmark> landmarks;  ///< map frame
  std::vector<KnownPosition> fixes;      ///< in order of time; where no whole pose is known (GROUND_TRUTH)
  Pose2 start_in_map;                    ///< pose of the base at the first observation; filters start there
  bool start_is_rough = false;           ///< that pose is a guess: maps must be aligned with the room to be judged
};

class ObservationSource {
 public:
  virtual ~ObservationSource() = default;
  /// The next observation in order of utime (at equal times: odometry, ground truth, then sightings), or nothing at
  /// the end. Each kind counts its own seq from 0. Never yields a number that is not finite.
  /// \throws InputError where the recording cannot be read further
  [[nodiscard]] virtual std::optional<Observation> next() = 0;
  [[nodiscard]] virtual const KnownWorld& world() const = 0;
};

}  // namespace noctule
