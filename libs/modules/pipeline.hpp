#pragma once
#include <memory>
#include <vector>

#include "bus/bus.hpp"
#include "modules/camera_module.hpp"
#include "modules/pipeline_parameters.hpp"
#include "modules/recorder_module.hpp"
#include "modules/source_module.hpp"

namespace noctule::modules {

/// Most threads that the modules may use; no result depends on it.
struct Threads {
  int count = 1;
};

/// The module a pipeline file asks for, to run alone or with others.
[[nodiscard]] std::unique_ptr<Module> make_slam(bus::Bus& bus, const PipelineParameters& parameters,
                                                const KnownWorld& world, Threads threads);
[[nodiscard]] std::unique_ptr<Module> make_mapper(bus::Bus& bus, const PipelineParameters& parameters,
                                                  const KnownWorld& world, PoseSource poses);

/// All modules of a pipeline file on one bus.
class Pipeline {
 public:
  /// \throws InputError when the source cannot be opened
  Pipeline(bus::Bus& bus, const PipelineParameters& parameters, Threads threads);

  /// When the next observation was measured [us]; nothing at the end.
  [[nodiscard]] std::optional<std::int64_t> next_utime() { return source_->next_utime(); }
  /// Takes one observation through all modules. False at the end, when all modules have said their last words.
  [[nodiscard]] bool step();
  /// Ends the run early, as if the source had come to its end.
  void stop();

  /// When the latest observation was measured, from the first on [s].
  [[nodiscard]] double data_seconds() const;
  /// What the run leaves behind. Meant for the end.
  [[nodiscard]] report::RunData data() const;

 private:
  void add_occupancy(report::RunData& data) const;
  void add_timing(report::RunData& data) const;

  bus::Bus& bus_;
  PipelineParameters parameters_;
  std::unique_ptr<SourceModule> source_;
  std::vector<std::unique_ptr<Module>> modules_;
  const CameraModule* camera_ = nullptr;  ///< one of them
  std::unique_ptr<RecorderModule> recorder_;
  std::vector<std::string> notes_;  ///< of the source
  double wall_seconds_ = 0.0;
};

}  // namespace noctule::modules
