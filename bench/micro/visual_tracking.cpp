/// Time of following one target from frame to frame: colour images of 640 x 480, a target of 48 pixels.
#include <benchmark/benchmark.h>

#include <vector>

#include "experiment/opencv_tracker.hpp"
#include "sensors/camera/target_tracker.hpp"
#include "sim/target_scene.hpp"

namespace {

using noctule::sensors::TargetProposal;

constexpr int kFrames = 24;

/// A film to and fro.
class Film {
 public:
  explicit Film(noctule::sim::TargetFilm film)
      : scene_({.film = film, .width = 640, .height = 480, .frames = kFrames, .radius = 24.0}, 1) {
    for (int k = 0; k < kFrames; ++k) images_.push_back(scene_.frame(k));
  }
  [[nodiscard]] const noctule::Image& first() const { return images_.front(); }
  [[nodiscard]] noctule::ImageBox target() const { return scene_.truth(0); }
  const noctule::Image& next() {
    at_ = (at_ + 1) % (2 * kFrames - 2);
    return images_[static_cast<std::size_t>(at_ < kFrames ? at_ : 2 * kFrames - 2 - at_)];
  }

 private:
  noctule::sim::TargetScene scene_;
  std::vector<noctule::Image> images_;
  int at_ = 0;
};

void track(benchmark::State& state, TargetProposal proposal) {
  Film film(noctule::sim::TargetFilm::smooth);
  noctule::sensors::TargetTrackerParameters p;
  p.proposal = proposal;
  p.particles = static_cast<int>(state.range(0));
  noctule::sensors::TargetTracker tracker(p, 1);
  tracker.start(film.first(), film.target());
  for (auto _ : state) benchmark::DoNotOptimize(tracker.track(film.next()).confidence);
  state.counters["frames/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(track, dynamics, TargetProposal::dynamics)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(track, saliency, TargetProposal::saliency)->Arg(200)->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(track, kalman, TargetProposal::kalman)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(track, unscented, TargetProposal::unscented)->Arg(200)->Unit(benchmark::kMillisecond);

void motion_saliency(benchmark::State& state) {
  Film film(noctule::sim::TargetFilm::pan);
  noctule::sensors::MotionSaliency saliency({});
  for (auto _ : state) saliency.update(film.next());
}
BENCHMARK(motion_saliency)->Unit(benchmark::kMillisecond);

void opencv(benchmark::State& state, const char* name) {
  Film film(noctule::sim::TargetFilm::smooth);
  noctule::experiment::OpencvTracker tracker(name);
  tracker.start(film.first(), film.target());
  for (auto _ : state) benchmark::DoNotOptimize(tracker.track(film.next()).size);
  state.counters["frames/s"] = benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(opencv, kcf, "opencv_kcf")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(opencv, csrt, "opencv_csrt")->Unit(benchmark::kMillisecond);

}  // namespace
