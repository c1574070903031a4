#pragma once
/// Modules that put observations on the bus: ODOMETRY, ULTRASONIC_SCAN, LANDMARK_DETECTIONS, GROUND_TRUTH,
/// CAMERA_IMAGE.
#include <filesystem>
#include <memory>
#include <optional>

#include "bus/log.hpp"
#include "core/source.hpp"
#include "modules/module.hpp"

namespace noctule::modules {

/// Where a pipeline's observations come from.
class SourceModule : public Module {
 public:
  explicit SourceModule(bus::Bus& bus);

  /// Publishes the next observation. False at the end, once the module has said that it finished.
  /// \throws InputError where the recording cannot be read further
  [[nodiscard]] bool step();
  /// When the next observation was measured [us]; nothing at the end.
  [[nodiscard]] virtual std::optional<std::int64_t> next_utime() = 0;

 protected:
  /// Called while there is a next observation.
  virtual void publish_next() = 0;
};

/// Publishes a simulator or a data set.
class ObservationModule : public SourceModule {
 public:
  /// \param jpeg_quality of pictures on the bus, from 1 to 100; 0: raw
  ObservationModule(bus::Bus& bus, std::unique_ptr<ObservationSource> source, int jpeg_quality = 0);
  [[nodiscard]] std::optional<std::int64_t> next_utime() override;

 private:
  void publish_next() override;
  void publish_as_jpeg(const CameraImage& image);

  std::unique_ptr<ObservationSource> source_;
  int jpeg_quality_;
  std::optional<Observation> next_;
  bool ended_ = false;
};

/// Publishes the observations in an LCM log again, as they were; what modules made of them is passed over.
class LogModule : public SourceModule {
 public:
  /// \param sightings whether LANDMARK_DETECTIONS are among what is published
  /// \throws InputError when the file cannot be opened
  LogModule(bus::Bus& bus, const std::filesystem::path& log, bool sightings = true);
  [[nodiscard]] std::optional<std::int64_t> next_utime() override;

 private:
  void publish_next() override;
  void read_next();

  bus::LogReader reader_;
  bool sightings_;
  std::optional<bus::LogEvent> next_;  ///< decodable; its utime is the message's own
  std::int64_t events_ = 0;
};

}  // namespace noctule::modules
