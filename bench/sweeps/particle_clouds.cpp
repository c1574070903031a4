/// Particle clouds before and after one step of PF, PSO-PF, BAT-PF and APF, as figures 1 to 3 of paper 002 show them,
/// for the growth model and for poses. sweep_particle_clouds FOLDER writes clouds_growth.svg and clouds_pose.svg.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "core/angles.hpp"
#include "models/growth_model.hpp"
#include "particle/apf.hpp"
#include "particle/resampling.hpp"
#include "particle/swarm.hpp"
#include "report/files.hpp"
#include "report/plot.hpp"
#include "report/text.hpp"

namespace {

using namespace noctule;
using namespace noctule::particle;

struct Cloud {
  std::vector<double> values;
  int dimension = 1;
  std::uint32_t angles = 0;
  [[nodiscard]] std::size_t size() const { return values.size() / static_cast<std::size_t>(dimension); }
  [[nodiscard]] States states() const { return {values.data(), size(), dimension, angles}; }
  [[nodiscard]] MutableStates states() { return {values.data(), size(), dimension, angles}; }
};

enum class Method { pf, pso, bat, apf };

/// The set that goes on.
template <class LogLikelihood>
Cloud after(const Cloud& before, const LogLikelihood& likelihood, Method method) {
  Cloud cloud = before;
  const std::size_t n = cloud.size();
  std::vector<double> fitness(n), weights(n);
  for (std::size_t i = 0; i < n; ++i) fitness[i] = likelihood(before.states()[i]);
  Rng rng(2, stream_id("clouds"));
  if (method == Method::pso) Swarm().pso(cloud.states(), fitness, likelihood, rng);
  if (method == Method::bat) Swarm().bat(cloud.states(), fitness, likelihood, rng);
  for (std::size_t i = 0; i < n; ++i) weights[i] = std::exp(fitness[i]);
  std::vector<std::uint32_t> counts(n), ancestors(n);
  Rng resampling(3, stream_id("clouds"));  // the same comb for all
  make_resampler(Resampling::systematic)->offspring(weights, static_cast<std::uint32_t>(n), resampling, counts);
  const Cloud weighted = cloud;
  Apf apf;
  std::span<const MovedParticle> moves;
  if (method == Method::apf) {
    moves = apf.optimise(weighted.states(), weights, counts, ancestors, rng);
  } else {
    place_in_slots(counts, ancestors);
  }
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(weighted.states()[ancestors[i]], cloud.dimension, cloud.states()[i]);
  }
  for (const MovedParticle& move : moves) apply_move(move, weighted.states(), cloud.states()[move.slot]);
  return cloud;
}

/// Four plots in one drawing, two by two.
std::string sheet(const std::vector<report::Plot>& plots, const std::string& description) {
  constexpr double kWidth = 560.0, kHeight = 360.0, kHead = 26.0;
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" viewBox=\"0 0 " +
                    report::fixed(2 * kWidth, 0) + " " + report::fixed(2 * (kHeight + kHead), 0) + "\"><title>" +
                    report::escape(description) + "</title>\n<style>\n" + report::printed_figure_style() +
                    "</style>\n<rect class=\"sheet\" width=\"100%\" height=\"100%\"/>\n";
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const double x = i % 2 == 0 ? 0.0 : kWidth, y = i < 2 ? 0.0 : kHeight + kHead;
    out += "<text class=\"axis-title\" x=\"" + report::fixed(x + 0.5 * kWidth, 0) + "\" y=\"" +
           report::fixed(y + 18.0, 0) + "\">" + report::escape(plots[i].title) + "</text>\n<svg x=\"" +
           report::fixed(x, 0) + "\" y=\"" + report::fixed(y + kHead, 0) + "\" width=\"" + report::fixed(kWidth, 0) +
           "\" height=\"" + report::fixed(kHeight, 0) + "\">\n" + report::plot_svg(plots[i]) + "</svg>\n";
  }
  return out + "</svg>\n";
}

constexpr std::pair<Method, const char*> kMethods[] = {
    {Method::pf, "PF"}, {Method::pso, "PSO-PF (local)"}, {Method::bat, "BAT-PF (local)"}, {Method::apf, "APF"}};

template <class LogLikelihood, class Point>
std::vector<report::Plot> plots(const Cloud& before, const LogLikelihood& likelihood, const Point& point,
                                const report::Plot& frame) {
  std::vector<report::Plot> result;
  for (const auto& [method, name] : kMethods) {
    report::Plot plot = frame;
    plot.title = name;
    plot.clouds = true;
    report::PlotSeries was{"before", "paper-7", {}}, is{"after", "series-0", {}};
    const Cloud next = after(before, likelihood, method);
    for (std::size_t i = 0; i < before.size(); ++i) {
      was.points.push_back(point(before.states()[i]));
      is.points.push_back(point(next.states()[i]));
    }
    plot.series = {was, is};
    result.push_back(plot);
  }
  return result;
}

/// A prediction that spreads over both signs, and a measurement that does not tell them apart.
std::string growth_sheet() {
  const models::GrowthModel model;
  Rng rng(4, stream_id("clouds"));
  Cloud before;
  for (int i = 0; i < 50; ++i) {
    double x = 1.5 * rng.normal(), mean = 0.0;
    model.motion(5)(&x, &mean);
    before.values.push_back(mean + model.process_sd * rng.normal());
  }
  const double z = model.expected_measurement(9.0);
  const auto likelihood = [&](const double* x) { return model.log_likelihood(x, z); };
  report::Plot frame;
  frame.x_title = "state";
  frame.y_title = "likelihood, largest = 1";
  return sheet(
      plots(
          before, likelihood,
          [&](const double* x) {
            return report::PlotPoint{.x = *x, .y = std::exp(likelihood(x)), .interval = {NAN, NAN}, .label = {}};
          },
          frame),
      "50 particles of the growth model before and after one step");
}

/// A drive of 20 steps by odometry, and a sighting of one landmark.
std::string pose_sheet() {
  Rng rng(5, stream_id("clouds"));
  Cloud before{{}, 3, 0b100};
  for (int i = 0; i < 100; ++i) {
    double pose[3] = {0.0, 0.0, 0.0};
    for (int step = 0; step < 20; ++step) {
      pose[2] = wrap(pose[2] + 0.04 + 0.06 * rng.normal());
      const double way = 0.25 + 0.05 * rng.normal();
      pose[0] += way * std::cos(pose[2]);
      pose[1] += way * std::sin(pose[2]);
    }
    before.values.insert(before.values.end(), pose, pose + 3);
  }
  const auto likelihood = [](const double* x) {
    const double dx = 6.0 - x[0], dy = 5.0 - x[1];
    const double range = (std::sqrt(dx * dx + dy * dy) - 3.2) / 0.15;
    const double bearing = wrap(std::atan2(dy, dx) - x[2] - 0.35) / 0.1;
    return -0.5 * (range * range + bearing * bearing);
  };
  report::Plot frame;
  frame.x_title = "x [m]";
  frame.y_title = "y [m]";
  return sheet(plots(
                   before, likelihood,
                   [](const double* x) {
                     return report::PlotPoint{.x = x[0], .y = x[1], .interval = {NAN, NAN}, .label = {}};
                   },
                   frame),
               "100 poses before and after one step");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: sweep_particle_clouds FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  report::write_file(folder / "clouds_growth.svg", growth_sheet());
  report::write_file(folder / "clouds_pose.svg", pose_sheet());
  return 0;
}
