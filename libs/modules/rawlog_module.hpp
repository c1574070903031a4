#pragma once
#include <filesystem>

#include "datasets/rawlog.hpp"
#include "modules/module.hpp"

namespace noctule::modules {

/// Writes the observations on the bus as an MRPT rawlog.
class RawlogModule : public Module {
 public:
  /// \throws InputError when the file cannot be created
  RawlogModule(bus::Bus& bus, const std::filesystem::path& file);

 private:
  void on_finish() override { writer_.close(); }

  datasets::RawlogWriter writer_;
};

}  // namespace noctule::modules
