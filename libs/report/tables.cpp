#include "report/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "report/table_html.hpp"
#include "report/text.hpp"

namespace noctule::report {
namespace {

struct Variant {
  std::string_view suffix;
  const char* heading;
  const char* css_class;
};
constexpr std::array<Variant, 3> kVariants{{{"", "This run", "estimate"},
                                            {"_known_pose", "Known pose", "limit"},
                                            {"_dead_reckoning", "Dead reckoning", "odometry"}}};

/// The name without the suffix of a variant.
std::string base_name(const std::string& name) {
  for (std::size_t v = 1; v < kVariants.size(); ++v) {
    if (name.ends_with(kVariants[v].suffix)) return name.substr(0, name.size() - kVariants[v].suffix.size());
  }
  return name;
}

const eval::Metric* find(const std::vector<eval::Metric>& metrics, const std::string& name) {
  const auto it = std::find_if(metrics.begin(), metrics.end(), [&](const eval::Metric& m) { return m.name == name; });
  return it == metrics.end() ? nullptr : &*it;
}

}  // namespace

std::optional<double> find_metric(const std::vector<eval::Metric>& metrics, const std::string& name) {
  const eval::Metric* metric = find(metrics, name);
  if (metric == nullptr || !std::isfinite(metric->value)) return std::nullopt;
  return metric->value;
}

std::string metric_table(const RunData& data) {
  if (data.metrics.empty()) return {};
  std::vector<std::string> names;
  for (const eval::Metric& m : data.metrics) {
    const std::string base = base_name(m.name);
    if (std::find(names.begin(), names.end(), base) == names.end()) names.push_back(base);
  }
  std::string head = column_head("Metric"), body;
  std::vector<Variant> variants;
  for (const Variant& v : kVariants) {
    const bool used = std::any_of(data.metrics.begin(), data.metrics.end(), [&](const eval::Metric& m) {
      return !v.suffix.empty() && m.name.ends_with(v.suffix);
    });
    if (v.suffix.empty() || used) variants.push_back(v);
  }
  for (const Variant& v : variants) head += column_head(v.heading, v.css_class);
  for (const std::string& name : names) {
    std::string cells = row_head("<code>" + escape(name) + "</code>");
    for (const Variant& v : variants) {
      const eval::Metric* m = find(data.metrics, name + std::string(v.suffix));
      cells += cell(m == nullptr ? "" : escape(quantity(m->value, m->unit)), v.css_class);
    }
    body += row(cells);
  }
  return table("Metrics", row(head), body);
}

std::string timing_table(const RunData& data) {
  if (data.timing.empty()) return {};
  std::string body;
  for (const eval::Metric& m : data.timing) {
    body += row(row_head("<code>" + escape(m.name) + "</code>") + cell(escape(quantity(m.value, m.unit))));
  }
  return table("Wall-clock figures", head_row({"Figure", "Value"}), body);
}

std::string module_table(const RunData& data) {
  if (data.modules.empty()) return {};
  std::string body;
  for (const ModuleReport& m : data.modules) {
    std::string cells = row_head(escape(m.name)) + cell(escape(m.state), "word");
    for (const std::int64_t count : {m.received, m.missed, m.duplicates, m.late, m.dropped, m.errors}) {
      cells += cell(std::to_string(count));
    }
    const std::string separator = m.warning.empty() || m.last_error.empty() ? "" : "; ";
    body += row(cells + cell(escape(m.warning + separator + m.last_error), "word"));
  }
  return table("Modules",
               head_row({"Module", "State", "Received", "Missed", "Twice", "Late", "Dropped", "Errors", "Remark"}),
               body);
}

}  // namespace noctule::report
