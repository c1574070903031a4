#include "modules/source_factory.hpp"

#include "sim/landmark_world.hpp"
#include "sim/room_geometry.hpp"
#include "sim/simulator.hpp"

namespace noctule::modules {
namespace {

using SourcePointer = std::unique_ptr<ObservationSource>;

SourcePointer open(const SimulatorParameters& p, std::uint64_t seed) {
  return std::make_unique<sim::Simulator>(p.world, p.robot, seed);
}
SourcePointer open(const sim::LandmarkWorldParameters& p, std::uint64_t seed) {
  return std::make_unique<sim::LandmarkWorld>(p, seed);
}
SourcePointer open(const datasets::MrclamParameters& p, std::uint64_t) {
  return std::make_unique<datasets::Mrclam>(p);
}
SourcePointer open(datasets::SonarCorridorParameters p, std::uint64_t seed) {
  p.noise.seed = seed;
  return std::make_unique<datasets::SonarCorridor>(p);
}
SourcePointer open(const datasets::SonarBigwheelParameters& p, std::uint64_t) {
  return std::make_unique<datasets::SonarBigwheel>(p);
}
SourcePointer open(const datasets::SonarScitos24Parameters& p, std::uint64_t) {
  return std::make_unique<datasets::SonarScitos24>(p);
}
SourcePointer open(const datasets::RawlogParameters& p, std::uint64_t) {
  return std::make_unique<datasets::RawlogSource>(p);
}
SourcePointer open(const datasets::UltrasonicRoomsParameters& p, std::uint64_t) {
  return std::make_unique<datasets::UltrasonicRooms>(p);
}
SourcePointer open(const datasets::VictoriaParkParameters& p, std::uint64_t) {
  return std::make_unique<datasets::VictoriaPark>(p);
}

SourcePointer open(const datasets::ImageFolderParameters& p, std::uint64_t) {
  return datasets::open_images(p);
}
SourcePointer open(const datasets::VideoParameters& p, std::uint64_t) {
  return datasets::open_video(p);
}
SourcePointer open(const datasets::CameraDeviceParameters& p, std::uint64_t) {
  return datasets::open_camera(p);
}

std::vector<std::string> notes_of(const ObservationSource& source) {
  const auto* recorded = dynamic_cast<const datasets::RecordedSource*>(&source);
  return recorded != nullptr ? recorded->notes() : std::vector<std::string>{};
}

KnownWorld world_of(const LogParameters& p) {
  KnownWorld world;
  if (!p.world) return world;
  world.name = p.world->name;
  world.room = sim::RoomGeometry(p.world->room).known_room();
  world.start_in_map = p.world->path.start;
  return world;
}

}  // namespace

SourceAndWorld make_source(bus::Bus& bus, const PipelineParameters& pipeline) {
  return std::visit(
      [&]<class P>(const P& p) -> SourceAndWorld {
        if constexpr (std::is_same_v<P, LogParameters>) {
          return {std::make_unique<LogModule>(bus, p.path, p.sightings), world_of(p), {}};
        } else {
          SourcePointer source = open(p, pipeline.seed);
          KnownWorld world = source->world();
          std::vector<std::string> notes = notes_of(*source);
          return {std::make_unique<ObservationModule>(bus, std::move(source), pipeline.jpeg_quality), std::move(world),
                  std::move(notes)};
        }
      },
      pipeline.source);
}

KnownWorld known_world(const SourceParameters& parameters) {
  return std::visit(
      []<class P>(const P& p) -> KnownWorld {
        if constexpr (std::is_same_v<P, LogParameters>) {
          return world_of(p);
        } else {
          return open(p, 0)->world();
        }
      },
      parameters);
}

}  // namespace noctule::modules
