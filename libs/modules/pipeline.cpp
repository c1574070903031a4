#include "modules/pipeline.hpp"

#include <chrono>

#include "core/error.hpp"
#include "modules/occupancy_image.hpp"
#include "modules/source_factory.hpp"
#include "modules/ultrasonic_module.hpp"

namespace noctule::modules {

std::unique_ptr<Module> make_slam(bus::Bus& bus, const PipelineParameters& parameters, const KnownWorld& world,
                                  Threads threads) {
  return std::make_unique<SlamModule>(
      bus, parameters.slam.value(),
      SlamInput{.features = parameters.ultrasonic.has_value(), .camera = parameters.camera.has_value()},
      parameters.seed, world.start_in_map, threads.count);
}

std::unique_ptr<Module> make_mapper(bus::Bus& bus, const PipelineParameters& parameters, const KnownWorld& world,
                                    PoseSource poses) {
  MapperModuleParameters mapping = parameters.mapping.value();
  // The limits are looked at once, at the end.
  if (poses != PoseSource::slam) mapping.incremental = false;
  const std::optional<Room> room = world.start_is_rough ? std::nullopt : world.room;
  return std::make_unique<MapperModule>(bus, mapping, MapperRole{poses, world.start_in_map, room});
}

Pipeline::Pipeline(bus::Bus& bus, const PipelineParameters& parameters, Threads threads)
    : bus_(bus), parameters_(parameters) {
  auto [source, world, notes] = make_source(bus, parameters);
  source_ = std::move(source);
  notes_ = std::move(notes);
  if (parameters.ultrasonic) modules_.push_back(std::make_unique<UltrasonicModule>(bus, *parameters.ultrasonic));
  if (parameters.camera) {
    auto camera = std::make_unique<CameraModule>(bus, *parameters.camera);
    camera_ = camera.get();
    modules_.push_back(std::move(camera));
  }
  if (parameters.slam) modules_.push_back(make_slam(bus, parameters, world, threads));
  if (parameters.mapping) {
    if (parameters.slam) modules_.push_back(make_mapper(bus, parameters, world, PoseSource::slam));
    modules_.push_back(make_mapper(bus, parameters, world, PoseSource::ground_truth));
    modules_.push_back(make_mapper(bus, parameters, world, PoseSource::odometry));
  }
  recorder_ = std::make_unique<RecorderModule>(bus, std::move(world));
}

bool Pipeline::step() {
  const auto begin = std::chrono::steady_clock::now();
  const bool more = source_->step();
  bus_.drain();
  wall_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!more) recorder_->finish();
  return more;
}

void Pipeline::stop() {
  source_->finish();
  while (step()) continue;
}

double Pipeline::data_seconds() const {
  return recorder_->data_seconds();
}

report::RunData Pipeline::data() const {
  report::RunData data = recorder_->data();
  data.title = parameters_.name;
  data.seed = parameters_.seed;
  data.notes.insert(data.notes.end(), notes_.begin(), notes_.end());
  if (camera_ != nullptr) data.camera = camera_->example();
  add_occupancy(data);
  add_timing(data);
  return data;
}

void Pipeline::add_occupancy(report::RunData& data) const {
  if (!parameters_.occupancy) return;
  const std::vector<mapping::PosedScan> scans = recorder_->best_posed_scans();
  if (scans.empty()) return;
  try {
    data.occupancy = occupancy_image(scans, *parameters_.occupancy);
  } catch (const InputError& error) {
    data.warnings.push_back(std::string("No occupancy map: ") + error.what());
  }
}

void Pipeline::add_timing(report::RunData& data) const {
  if (wall_seconds_ > 0.0) data.timing.push_back({"realtime_factor", data.duration / wall_seconds_, "1"});
  data.timing.push_back({"wall_time", wall_seconds_, "s"});
  const auto add = [&](const Module& module) {
    const LatencyHistogram& durations = module.durations();
    data.timing.push_back({module.name() + "_cpu_time", module.cpu_seconds(), "s"});
    data.timing.push_back({module.name() + "_latency_p50", durations.percentile(0.50), "s"});
    data.timing.push_back({module.name() + "_latency_p95", durations.percentile(0.95), "s"});
    data.timing.push_back({module.name() + "_latency_p99", durations.percentile(0.99), "s"});
    data.timing.push_back({module.name() + "_latency_max", durations.max(), "s"});
  };
  add(*source_);
  for (const auto& module : modules_) add(*module);
  add(*recorder_);
}

}  // namespace noctule::modules
