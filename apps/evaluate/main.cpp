/// Figures of any result against any truth, from files alone.
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>

#include "apps/common/command_line.hpp"
#include "apps/evaluate/judge.hpp"
#include "core/angles.hpp"
#include "core/error.hpp"
#include "report/files.hpp"
#include "report/json.hpp"

namespace {

using namespace noctule;
namespace fs = std::filesystem;

struct Arguments {
  std::vector<fs::path> places;  ///< a results folder, or estimate and truth
  apps::EvaluationFiles files;
  apps::EvaluationOptions options;
  fs::path json;
};

template <class Enum>
CLI::CheckedTransformer one_of(const std::map<std::string, Enum>& names) {
  CLI::CheckedTransformer transformer(names);
  return transformer;
}

void add_options(CLI::App& app, Arguments& a) {
  apps::EvaluationFiles& f = a.files;
  apps::EvaluationOptions& o = a.options;
  app.add_option("PLACE", a.places, "a folder of results (noctule-pipeline), or two TUM files: estimate and truth")
      ->expected(0, 2);
  app.add_option("--estimate", f.estimate, "trajectory (TUM)");
  app.add_option("--truth", f.truth, "true trajectory (TUM)");
  app.add_option("--fixes", f.fixes, "true positions instead: CSV t,x,y");
  app.add_option("--align", o.alignment, "estimate to truth, for ate_*: none, se2 (turn about z), se3 or sim3")
      ->transform(one_of<eval::Alignment3>({{"none", eval::Alignment3::none},
                                            {"se2", eval::Alignment3::yaw},
                                            {"se3", eval::Alignment3::rigid},
                                            {"sim3", eval::Alignment3::similarity}}))
      ->option_text("NAME");
  app.add_option("--associate", o.association,
                 "truth at the time of each estimate: interpolate, or nearest as evo does")
      ->transform(one_of<apps::Association>(
          {{"interpolate", apps::Association::interpolate}, {"nearest", apps::Association::nearest}}))
      ->option_text("NAME");
  app.add_option("--max-difference", o.max_difference, "of two times that are paired (nearest) [s]")
      ->capture_default_str();
  app.add_option("--max-gap", o.max_gap, "between poses that are interpolated [s]")->capture_default_str();
  app.add_option("--rpe-length", o.lengths, "segments of the relative error by way driven [m], e.g. 1,5,10")
      ->delimiter(',');
  app.add_option("--rpe-time", o.durations, "... by time [s]")->delimiter(',');
  app.add_option("--rpe-steps", o.steps, "... by number of poses")->delimiter(',');
  app.add_option(
         "--segments", o.segments,
         "every_pose: begin everywhere; end_to_end: one after the other; nearest: begin everywhere and end where "
         "the way is nearest to the length (lengths only; within 10 %)")
      ->transform(one_of<apps::SegmentChoice>({{"every_pose", apps::SegmentChoice::every_pose},
                                               {"end_to_end", apps::SegmentChoice::end_to_end},
                                               {"nearest", apps::SegmentChoice::nearest}}))
      ->option_text("NAME");
  app.add_option("--landmarks", f.landmarks, "estimated landmarks: CSV id,x,y");
  app.add_option("--known-landmarks", f.known_landmarks, "true landmarks, likewise");
  app.add_option("--pair", o.pairing, "landmarks by id, or by distance (default: by id where the files share one)")
      ->transform(one_of<apps::Pairing>({{"id", apps::Pairing::id}, {"distance", apps::Pairing::distance}}))
      ->option_text("NAME");
  app.add_flag("--align-landmarks", o.align_landmarks, "move the estimated landmarks to the true ones (SE(2)) first");
  app.add_option("--gate", o.gate, "landmarks farther apart than this are no pair (distance) [m]")
      ->capture_default_str();
  app.add_option("--order", o.order, "p of OSPA and GOSPA")->capture_default_str();
  app.add_option("--cutoff", o.cutoff, "c of OSPA and GOSPA [m]")->capture_default_str();
  app.add_option("--walls", f.walls, "estimated walls: CSV rho,theta,begin,end");
  app.add_option("--cylinders", f.cylinders, "estimated cylinders: CSV x,y,radius");
  app.add_option("--known-walls", f.known_walls, "true walls, likewise");
  app.add_option("--known-cylinders", f.known_cylinders, "true cylinders, likewise");
  app.add_option("--world", f.world, "the true room as a world file (config/worlds/*.yaml)");
  app.add_option("--json", a.json, "write the figures there, SI; -: to the terminal instead of the table");
}

void check(const apps::EvaluationOptions& o) {
  const auto positive = [](const std::string& name, double value) {
    if (!(value > 0.0 && std::isfinite(value))) {
      throw InputError(name + ": expected a number > 0, got " + std::to_string(value));
    }
  };
  for (const double v : o.lengths) positive("--rpe-length", v);
  for (const double v : o.durations) positive("--rpe-time", v);
  for (const double v : o.steps) {
    positive("--rpe-steps", v);
    if (v != std::floor(v) || v > 1e9)
      throw InputError("--rpe-steps: expected whole numbers, got " + std::to_string(v));
  }
  positive("--max-difference", o.max_difference);
  positive("--max-gap", o.max_gap);
  positive("--gate", o.gate);
  positive("--cutoff", o.cutoff);
  if (!(o.order >= 1.0 && std::isfinite(o.order))) throw InputError("--order: expected a number >= 1");
}

void place(Arguments& a) {
  if (a.places.size() == 2) {
    a.files.estimate = a.places[0];
    a.files.truth = a.places[1];
  } else if (a.places.size() == 1) {
    if (!fs::is_directory(a.places[0])) {
      throw InputError(a.places[0].string() + ": expected a folder of results, or two trajectories");
    }
    apps::complete_from_results(a.places[0], a.files);
  }
}

std::string printed(const eval::Metric& m) {
  if (!std::isfinite(m.value)) return "-";
  std::array<char, 48> text{};
  const bool length = m.unit == "m", angle = m.unit == "rad", count = m.value == std::floor(m.value);
  std::snprintf(text.data(), text.size(),
                angle    ? "%.3f deg"
                : length ? "%.4f m"
                : count  ? "%.0f"
                         : "%.4f",
                angle ? degrees(m.value) : m.value);
  return text.data();
}

int run(Arguments a) {
  check(a.options);
  place(a);
  const std::vector<eval::Metric> metrics = apps::evaluate(a.files, a.options);
  if (!a.json.empty() && a.json != "-") report::write_file(a.json, report::metrics_json(metrics));
  if (a.json == "-") {
    std::cout << report::metrics_json(metrics);
    return 0;
  }
  for (const eval::Metric& m : metrics) std::printf("%-36s %14s\n", m.name.c_str(), printed(m).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Judges trajectories, landmarks and contour maps against a truth, all from files.", "noctule-evaluate");
  app.set_version_flag("--version", "noctule-evaluate " + apps::version());
  Arguments arguments;
  add_options(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    std::cerr << "noctule-evaluate: " << error.what() << " (see --help)\n";
    return 2;
  }
  return apps::run_guarded("noctule-evaluate", [&] { return run(arguments); });
}
