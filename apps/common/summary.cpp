#include "apps/common/summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/angles.hpp"

namespace noctule::apps {
namespace {

const eval::Metric* find(const std::vector<eval::Metric>& metrics, const std::string& name) {
  const auto metric = std::ranges::find(metrics, name, &eval::Metric::name);
  return metric == metrics.end() ? nullptr : &*metric;
}

std::string print(const eval::Metric* metric) {
  if (metric == nullptr || !std::isfinite(metric->value)) return "-";
  std::array<char, 48> text{};
  const char* format = "%.4g";
  double value = metric->value;
  if (metric->unit == "m") {
    value *= 100.0;
    format = "%.2f cm";
  } else if (metric->unit == "rad") {
    value = degrees(value);
    format = "%.2f deg";
  }
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

struct Row {
  const char* title;
  const char* metric;
};
constexpr std::array kRows{Row{"walls found", "walls_found"},          Row{"walls missed", "walls_missed"},
                           Row{"walls invented", "walls_invented"},    Row{"cylinders found", "cylinders_found"},
                           Row{"wall distance error", "wall_mae_rho"}, Row{"wall angle error", "wall_mae_theta"},
                           Row{"cylinder error", "cylinder_mae"},      Row{"position error (rms)", "position_rmse"},
                           Row{"heading error (rms)", "heading_rmse"}, Row{"landmark error (rms)", "landmark_rmse"}};

}  // namespace

void print_summary(std::ostream& out, const report::RunData& data, const std::string& folder) {
  std::array<char, 160> text{};
  const auto print_row = [&](const char* title, const std::string& a, const std::string& b, const std::string& c) {
    std::snprintf(text.data(), text.size(), "%-24s %14s %16s %16s\n", title, a.c_str(), b.c_str(), c.c_str());
    out << text.data();
  };
  const bool any = std::ranges::any_of(kRows, [&](const Row& r) { return find(data.metrics, r.metric) != nullptr; });
  if (any) print_row(data.title.c_str(), "estimate", "dead reckoning", "known poses");
  for (const Row& row : kRows) {
    const std::string name = row.metric;
    const eval::Metric* metric = find(data.metrics, name);
    if (metric == nullptr) continue;
    print_row(row.title, print(metric), print(find(data.metrics, name + "_dead_reckoning")),
              print(find(data.metrics, name + "_known_pose")));
  }
  std::snprintf(text.data(), text.size(), "%.0f s of data, %s times real time\n", data.duration,
                print(find(data.timing, "realtime_factor")).c_str());
  out << text.data();
  for (const std::string& note : data.notes) out << "note: " << note << "\n";
  for (const std::string& warning : data.warnings) out << "warning: " << warning << "\n";
  out << folder << "/report.html\n";
}

}  // namespace noctule::apps
