#pragma once
/// Executables that run one module as a process of its own.
#include <functional>
#include <memory>

#include "apps/common/command_line.hpp"
#include "modules/module.hpp"

namespace noctule::apps {

using ModuleFactory =
    std::function<std::unique_ptr<modules::Module>(bus::Bus&, const modules::PipelineParameters&, const CommandLine&)>;

/// Runs the module until those it waits for have finished, or until Ctrl-C; then it publishes what it holds back.
/// \returns the exit code
[[nodiscard]] int run_single_module(int argc, char** argv, const Program& program, const ModuleFactory& make);

}  // namespace noctule::apps
