/// The main job: all modules of a pipeline file in one process, and a folder of results.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "apps/common/command_line.hpp"
#include "apps/common/interrupt.hpp"
#include "apps/common/pacer.hpp"
#include "apps/common/summary.hpp"
#include "core/error.hpp"
#include "modules/pipeline.hpp"
#include "modules/pipeline_file.hpp"
#include "modules/rawlog_module.hpp"
#include "report/results.hpp"

namespace {

using namespace noctule;
namespace fs = std::filesystem;

constexpr const char* kLogName = "run.lcmlog";
constexpr int kExitInterrupted = 130;  // as shells say it of Ctrl-C

/// A line on the terminal that says how far the run is, four times a second. Nothing when it goes elsewhere.
class Progress {
 public:
  explicit Progress(bool wanted) : shown_(wanted && isatty(STDERR_FILENO) != 0) {}
  ~Progress() { clear(); }

  void show(double data_seconds) {
    const auto now = std::chrono::steady_clock::now();
    if (!shown_ || now < next_) return;
    next_ = now + std::chrono::milliseconds(250);
    std::fprintf(stderr, "\r%.1f s of data ", data_seconds);
  }
  void clear() const {
    if (shown_) std::fprintf(stderr, "\r%30s\r", "");
  }

 private:
  bool shown_;
  std::chrono::steady_clock::time_point next_;
};

/// The folder of results while the run lasts. A run that fails leaves nothing of itself; one that is killed leaves its
/// log, readable up to the last message, and no figures of an earlier run beside it.
class ResultsFolder {
 public:
  explicit ResultsFolder(fs::path dir) : dir_(std::move(dir)), existed_(fs::exists(dir_)) {
    report::prepare_results(dir_);
    for (const char* name : {"metrics.json",   "metrics.csv",     "timing.json",         "config.yaml",
                             "trajectory.tum", "path.tum",        "ground_truth.tum",    "dead_reckoning.tum",
                             "fixes.csv",      "landmarks.csv",   "known_landmarks.csv", "walls.csv",
                             "cylinders.csv",  "known_walls.csv", "known_cylinders.csv", "map.svg",
                             "map.pgm",        "map.yaml",        "report.html",         "run.rawlog"}) {
      fs::remove(dir_ / name);  // of an earlier run
    }
  }
  ~ResultsFolder() {
    if (kept_) return;
    std::error_code ignored;
    fs::remove(log(), ignored);
    fs::remove(rawlog(), ignored);
    if (!existed_) fs::remove(dir_, ignored);  // only when empty
  }

  [[nodiscard]] fs::path log() const { return dir_ / kLogName; }
  [[nodiscard]] fs::path rawlog() const { return dir_ / "run.rawlog"; }
  void write(const report::RunData& data) {
    kept_ = true;
    report::write_results(data, dir_);
  }

 private:
  fs::path dir_;
  bool existed_;
  bool kept_ = false;
};

/// The log that is played must not be the one that is written.
void check_log(const modules::SourceParameters& source, const fs::path& written) {
  const auto* log = std::get_if<modules::LogParameters>(&source);
  std::error_code no_such_file;
  if (log != nullptr && fs::equivalent(log->path, written, no_such_file)) {
    throw InputError("--out: expected another folder than that of the log that is played, " + log->path.string());
  }
}

int run(const apps::CommandLine& line, const std::string& out, double speed) {
  const modules::PipelineParameters parameters = apps::load_pipeline(line);
  const std::string config_yaml = modules::dump_pipeline(parameters);
  if (line.print_config) {
    std::cout << config_yaml;
    return 0;
  }
  check_log(parameters.source, fs::path(out) / kLogName);
  const auto bus = apps::open_bus(line);
  modules::Pipeline pipeline(*bus, parameters, modules::Threads{line.threads});
  ResultsFolder results(out);
  std::set<std::string> unrecorded{bus::channel::kTiming};
  if (!parameters.record_images) unrecorded.insert(bus::channel::kCameraImage);
  bus->record_to(bus::LogWriter(results.log()), std::move(unrecorded));
  std::optional<modules::RawlogModule> rawlog;
  if (parameters.rawlog) rawlog.emplace(*bus, results.rawlog());

  apps::catch_interrupts();
  Progress progress(line.log_level >= apps::LogLevel::info);
  apps::Pacer pacer(speed);
  for (auto utime = pipeline.next_utime(); !apps::interrupted(); utime = pipeline.next_utime()) {
    if (utime) pacer.wait_for(*utime);
    if (!pipeline.step()) break;
    progress.show(pipeline.data_seconds());
  }
  if (apps::interrupted()) pipeline.stop();
  progress.clear();

  report::RunData data = pipeline.data();
  data.version = apps::version();
  data.config_yaml = config_yaml;
  if (apps::interrupted()) data.warnings.push_back("The run was stopped before the end of its data.");
  results.write(data);
  if (line.log_level >= apps::LogLevel::info) apps::print_summary(std::cout, data, out);
  return apps::interrupted() ? kExitInterrupted : 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string out = "results/run", speed = "0";
  const apps::Program program{.name = "noctule-pipeline",
                              .description = "Runs a pipeline in one process and writes a folder of results.",
                              .default_bus = "memq://",
                              .options = {{"--out", &out, "folder of results"},
                                          {"--speed", &speed, "times real time, to watch it; 0: as fast as possible"}}};
  const apps::CommandLine line = apps::parse_command_line(argc, argv, program);
  return apps::run_guarded(program.name, [&] { return run(line, out, apps::parse_option("--speed", speed, 0.0)); });
}
