/// Monte-Carlo comparison of filters on the same random numbers.
#include <CLI/CLI.hpp>
#include <iostream>

#include "apps/common/command_line.hpp"
#include "apps/experiment/commands.hpp"

namespace {

using namespace noctule;
namespace fs = std::filesystem;

void add_experiment(CLI::App& command, apps::ExperimentArguments& arguments) {
  command.add_option("FILE", arguments.file, "experiment (config/experiments/*.yaml)")->required();
  command.add_option("--seeds", arguments.seeds, "FIRST-LAST instead of the file's");
  command
      .add_option("--set", arguments.assignments, "KEY=VALUE instead of the file's, e.g. scenarios[0].config.robot...")
      ->allow_extra_args(false)
      ->take_all();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares filters on the same random numbers.", "noctule-experiment");
  app.set_version_flag("--version", "noctule-experiment " + apps::version());
  app.require_subcommand(1);
  apps::ExperimentArguments arguments;
  std::string shard;
  fs::path out = "results/experiment", listed;
  std::string a, b;
  fs::path csv;
  std::vector<fs::path> markdown;
  bool check = false;
  int jobs = 1;
  std::vector<fs::path> shards;

  CLI::App* run = app.add_subcommand("run", "run it, or go on with a run that was interrupted");
  add_experiment(*run, arguments);
  run->add_option("--jobs", jobs, "seeds at the same time; no result depends on it")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  run->add_option("--shard", shard, "I/N: the I-th of N parts, from 0 (default: as Slurm's job array says)");
  run->add_option("--out", out, "folder of results")->capture_default_str();

  CLI::App* merge = app.add_subcommand("merge", "join the folders of all shards");
  add_experiment(*merge, arguments);
  merge->add_option("SHARDS", shards, "folders that the shards wrote")->required();
  merge->add_option("--out", out, "folder of results")->capture_default_str();

  CLI::App* list = app.add_subcommand("list", "print scenarios, filters, metrics and the number of runs");
  add_experiment(*list, arguments);
  list->add_option("--out", listed, "folder of results: print what is done there");

  CLI::App* report = app.add_subcommand("report", "write report.html, tables.tex, comparisons.csv and figures");
  report->add_option("DIR", out, "folder of results")->required();

  CLI::App* compare = app.add_subcommand("compare", "print paired differences of two filters, or of two folders");
  compare->add_option("A", a, "FOLDER, FILTER, FILTER:PARAMETERS or FOLDER:FILTER:PARAMETERS")->required();
  compare->add_option("B", b, "the same, to compare with")->required();
  compare->add_option("--in", out, "folder of those that name none")->capture_default_str();
  compare->add_option("--csv", csv, "write them to this file too");

  CLI::App* pages = app.add_subcommand("pages", "refresh the tables and figures of Markdown pages (docs/results)");
  pages->add_option("PAGES", markdown, "pages")->required();
  pages->add_flag("--check", check, "change nothing; fail where a page quotes what its results do not say");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help, version
    std::cerr << "noctule-experiment: " << error.what() << " (see --help)\n";
    return 2;
  }
  return apps::run_guarded("noctule-experiment", [&] {
    if (run->parsed()) return apps::run_experiment(arguments, out, jobs, shard);
    if (pages->parsed()) return apps::refresh_pages(markdown, check);
    if (merge->parsed()) apps::merge_shards(arguments, shards, out);
    if (report->parsed()) apps::report_experiment(out);
    if (compare->parsed()) apps::compare_results(a, b, out, csv);
    if (list->parsed()) apps::list_experiment(arguments, listed);
    return 0;
  });
}
