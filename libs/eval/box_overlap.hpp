#pragma once
/// How well one estimated box a frame follows the true one: the figures of the Visual Tracker Benchmark (Wu, Lim and
/// Yang, CVPR 2013).
#include <span>
#include <vector>

#include "core/image_box.hpp"

namespace noctule::eval {

struct BoxTrackScores {
  int frames = 0;            ///< judged
  double overlap = 0.0;      ///< mean of intersection over union
  double success_auc = 0.0;  ///< mean over thresholds 0, 0.05 .. 1 of the share of frames whose overlap exceeds them
  double precision20 = 0.0;  ///< share of frames whose centre is within 20 pixels
  double centre_rmse = 0.0;  ///< [pixels]
};

/// Share of frames whose overlap exceeds the threshold: a point of the success plot. NaN for no frames.
[[nodiscard]] double success(std::span<const double> overlaps, double threshold);

/// All figures NaN for no frames. \throws std::invalid_argument when the lengths differ
[[nodiscard]] BoxTrackScores box_track_scores(std::span<const ImageBox> estimates, std::span<const ImageBox> truth);

/// A target that was lost: how many frames until the overlap exceeded 0.5 again.
struct Reacquisition {
  int frames = 0;      ///< 0: in the very frame of the loss; when it was not found, until the end
  bool found = false;  ///< before the next loss or the end
};
/// \param overlaps of every frame \param losses ascending indices of frames
/// \throws std::invalid_argument for losses that do not ascend or lie outside
[[nodiscard]] std::vector<Reacquisition> reacquisitions(std::span<const double> overlaps, std::span<const int> losses);

}  // namespace noctule::eval
