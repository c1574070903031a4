#include "experiment/pages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <regex>
#include <set>

#include "config/config.hpp"
#include "core/angles.hpp"
#include "core/error.hpp"
#include "experiment/comparison.hpp"
#include "experiment/experiment.hpp"
#include "experiment/results.hpp"
#include "experiment/table.hpp"
#include "report/text.hpp"

namespace noctule::experiment {
namespace {

namespace fs = std::filesystem;

enum class Show { inherit, interval, mean, sd, n, count, diverged, difference, percent, p, p_holm };

/// What a row, a column, a figure or the page's data say; the rest is left to the others.
struct CellSpec {
  std::string title;
  std::string results;
  std::string experiment;
  std::string scenario;
  std::string filter;
  std::string parameters;
  std::string metric;
  std::string source;
  std::string against;
  std::string against_parameters;
  std::string unit;
  int decimals = -1;
  Show show = Show::inherit;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.field("title", &CellSpec::title, "head of the row or column");
    v.field("results", &CellSpec::results, "folder with summary.csv, timing.csv and comparisons.csv");
    v.field("experiment", &CellSpec::experiment, "experiment file, for published figures");
    v.field("scenario", &CellSpec::scenario, "scenario");
    v.field("filter", &CellSpec::filter, "filter, or the name that a source gives it");
    v.field("parameters", &CellSpec::parameters, "as in the tables: key=value;key=value");
    v.field("metric", &CellSpec::metric, "metric");
    v.field("source", &CellSpec::source, "of a published figure");
    v.field("against", &CellSpec::against, "the other filter of a comparison");
    v.field("against_parameters", &CellSpec::against_parameters, "its parameters");
    v.field("unit", &CellSpec::unit, "in which it is printed: cm, m, mm, deg, rad, s, ms, us, % or 1");
    v.field("decimals", &CellSpec::decimals, unit::one, "of the printed number", between(-1, 12));
    v.choice("show", &CellSpec::show,
             {{"inherit", Show::inherit},
              {"interval", Show::interval},
              {"mean", Show::mean},
              {"sd", Show::sd},
              {"n", Show::n},
              {"count", Show::count},
              {"diverged", Show::diverged},
              {"difference", Show::difference},
              {"percent", Show::percent},
              {"p", Show::p},
              {"p_holm", Show::p_holm}},
             "mean with interval, mean, sd, number of runs, sum of ones, diverged runs, or of a comparison");
  }
};

struct TableSpec {
  std::vector<CellSpec> columns;
  std::vector<CellSpec> rows;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.list("columns", &TableSpec::columns, "from left to right");
    v.list("rows", &TableSpec::rows, "from top to bottom");
  }
};

/// `over` where it says something, else `base`; parameters of both together.
CellSpec merged(CellSpec base, const CellSpec& over) {
  if (!base.parameters.empty() && !over.parameters.empty()) base.parameters += ';';
  base.parameters += over.parameters;
  for (auto member :
       {&CellSpec::title, &CellSpec::results, &CellSpec::experiment, &CellSpec::scenario, &CellSpec::filter,
        &CellSpec::metric, &CellSpec::source, &CellSpec::against, &CellSpec::against_parameters, &CellSpec::unit}) {
    if (!(over.*member).empty()) base.*member = over.*member;
  }
  if (over.decimals >= 0) base.decimals = over.decimals;
  if (over.show != Show::inherit) base.show = over.show;
  return base;
}

/// Files that a page reads, each once.
class Sources {
 public:
  const std::vector<SummaryRow>& summary(const fs::path& folder) {
    return cached(summaries_, folder, [&] {
      std::vector<SummaryRow> rows = read_summary(folder / "summary.csv");
      if (fs::exists(folder / "timing.csv")) {
        const std::vector<SummaryRow> timing = read_summary(folder / "timing.csv");
        rows.insert(rows.end(), timing.begin(), timing.end());
      }
      return rows;
    });
  }
  const std::vector<Comparison>& comparisons(const fs::path& folder) {
    return cached(comparisons_, folder, [&] { return read_comparisons(folder / "comparisons.csv"); });
  }
  const Experiment& experiment(const fs::path& file) {
    return cached(experiments_, file, [&] { return config::load<Experiment>(file); });
  }

 private:
  template <class Value, class Read>
  static const Value& cached(std::map<fs::path, Value>& cache, const fs::path& key, const Read& read) {
    const auto at = cache.find(key);
    return at != cache.end() ? at->second : cache.emplace(key, read()).first->second;
  }

  std::map<fs::path, std::vector<SummaryRow>> summaries_;
  std::map<fs::path, std::vector<Comparison>> comparisons_;
  std::map<fs::path, Experiment> experiments_;
};

/// Printed = SI * scale.
double scale_of(const std::string& unit) {
  static const std::map<std::string, double> kScales{{"m", 1.0}, {"cm", 100.0}, {"mm", 1e3},          {"rad", 1.0},
                                                     {"s", 1.0}, {"ms", 1e3},   {"us", 1e6},          {"%", 100.0},
                                                     {"1", 1.0}, {"", 1.0},     {"deg", degrees(1.0)}};
  const auto at = kScales.find(unit);
  if (at == kScales.end())
    throw InputError("unit: expected cm, m, mm, deg, rad, s, ms, us, % or 1, got '" + unit + "'");
  return at->second;
}

/// In any order.
bool same_parameters(const std::string& a, const std::string& b) {
  const auto sorted = [](const std::string& parameters) {
    auto list = assignments(parameters);
    std::ranges::sort(list);
    return list;
  };
  return sorted(a) == sorted(b);
}

bool fits(const Subject& subject, const std::string& scenario, const std::string& filter,
          const std::string& parameters) {
  return subject.scenario == scenario && subject.filter == filter && same_parameters(subject.parameters, parameters);
}

std::string what(const CellSpec& c) {
  return "scenario '" + c.scenario + "', filter '" + c.filter + "', parameters '" + c.parameters + "', metric '" +
         c.metric + "'";
}

std::string number(const CellSpec& c, double si) {
  constexpr int kUsual = 2;
  if (!std::isfinite(si)) return "-";
  return report::fixed(si * scale_of(c.unit), c.decimals < 0 ? kUsual : c.decimals);
}

std::string with_interval(const CellSpec& c, double mean, const Interval& interval) {
  if (!std::isfinite(interval.low)) return number(c, mean);
  return number(c, mean) + " [" + number(c, interval.low) + ", " + number(c, interval.high) + "]";
}

/// Of the source with that name, else of the first whose name begins with it: `table` is any table.
std::string published(const CellSpec& c, Sources& sources) {
  const Reference* found = nullptr;
  for (const Reference& r : sources.experiment(c.experiment).references) {
    const bool fits = r.filter == c.filter && r.scenario == c.scenario && r.metric == c.metric &&
                      same_parameters(r.parameters, c.parameters) && r.source.starts_with(c.source);
    if (fits && (found == nullptr || r.source == c.source)) found = &r;
  }
  return found == nullptr ? "" : number(c, found->value);
}

std::string compared(const CellSpec& c, Sources& sources) {
  const std::string& parameters = c.against_parameters.empty() ? c.parameters : c.against_parameters;
  for (const Comparison& row : sources.comparisons(c.results)) {
    const bool both =
        fits(row.subject, c.scenario, c.filter, c.parameters) && fits(row.against, c.scenario, c.against, parameters);
    if (!both || row.metric != c.metric) continue;
    if (c.show == Show::percent) return report::fixed(row.percent, c.decimals < 0 ? 1 : c.decimals);
    if (c.show == Show::p) return p_value_text(row.p_value, "-");
    if (c.show == Show::p_holm) return p_value_text(row.p_holm, "-");
    return with_interval(c, row.difference, row.ci95);
  }
  throw InputError("no such comparison in " + c.results + ": " + what(c) + " against '" + c.against +
                   "', parameters '" + parameters + "'");
}

std::string measured(const CellSpec& c, Sources& sources) {
  const bool any_metric = c.show == Show::diverged && c.metric.empty();
  for (const SummaryRow& row : sources.summary(c.results)) {
    if (!fits(row.subject, c.scenario, c.filter, c.parameters) || (!any_metric && row.metric != c.metric)) continue;
    switch (c.show) {
      case Show::mean:
        return number(c, row.mean);
      case Show::sd:
        return number(c, row.sd);
      case Show::n:
        return std::to_string(row.n);
      case Show::count:
        return report::fixed(row.mean * row.n, 0) + " of " + std::to_string(row.n);
      case Show::diverged:
        return std::to_string(row.diverged);
      default:
        return with_interval(c, row.mean, row.ci95);
    }
  }
  throw InputError("not in " + c.results + "/summary.csv: " + what(c));
}

std::string cell_text(const CellSpec& c, Sources& sources) {
  if (!c.source.empty()) return published(c, sources);
  const bool comparison =
      c.show == Show::difference || c.show == Show::percent || c.show == Show::p || c.show == Show::p_holm;
  return comparison ? compared(c, sources) : measured(c, sources);
}

std::string table_text(const TableSpec& table, const CellSpec& data, Sources& sources) {
  std::string text = "\n|", rule = "|---|";
  text += " |";
  for (const CellSpec& column : table.columns) {
    text += ' ' + column.title + " |";
    rule += "---|";
  }
  text += '\n' + rule + '\n';
  for (const CellSpec& row : table.rows) {
    text += "| " + row.title + " |";
    for (const CellSpec& column : table.columns) {
      const std::string cell = cell_text(merged(merged(data, column), row), sources);
      text += ' ' + (cell.empty() ? "" : cell + ' ') + '|';
    }
    text += '\n';
  }
  return text;
}

/// A block of a page: `<!-- word specification -->`, and for tables and figures what was made of it up to
/// `<!-- /word -->`.
struct Block {
  std::size_t begin = 0;  ///< of the opening mark
  std::string word;
  std::string specification;
  std::size_t content = 0;  ///< of the generated text; npos for data
  std::size_t content_end = 0;
  std::size_t end = 0;
};

std::string line_text(const std::string& text, std::size_t place) {
  return std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
}

std::vector<Block> blocks_of(const std::string& text, const std::string& name) {
  static constexpr std::array kWords{"data", "table", "figure"};
  constexpr std::string_view kOpen = "<!-- ", kClose = "-->";
  std::vector<Block> blocks;
  for (std::size_t at = text.find(kOpen); at != std::string::npos; at = text.find(kOpen, at)) {
    const auto word = std::ranges::find_if(kWords, [&](const std::string& w) {
      const std::size_t end = at + kOpen.size() + w.size();
      return text.compare(at + kOpen.size(), w.size(), w) == 0 && end < text.size() &&
             std::isspace(static_cast<unsigned char>(text[end])) != 0;
    });
    const std::size_t close = text.find(kClose, at);
    if (word == kWords.end() || close == std::string::npos) {
      at += kOpen.size();
      continue;
    }
    Block block{at, *word, "", close + kClose.size(), 0, 0};
    const std::size_t begin = at + kOpen.size() + block.word.size();
    block.specification = text.substr(begin, close - begin);
    block.content_end = block.end = block.content;
    if (block.word != "data") {
      const std::string mark = "<!-- /" + block.word + " -->";
      block.content_end = text.find(mark, block.content);
      if (block.content_end == std::string::npos) {
        throw InputError(name + ":" + line_text(text, at) + ": expected '" + mark + "' behind it");
      }
      block.end = block.content_end + mark.size();
    }
    at = block.end;
    blocks.push_back(std::move(block));
  }
  return blocks;
}

/// From the folder of the page.
std::string beside(const fs::path& page, const std::string& path) {
  return path.empty() ? path : (page.parent_path() / path).lexically_normal().string();
}

/// The text without code and without the blocks, whose places become spaces.
std::string open_text(const std::string& text, const std::vector<Block>& blocks) {
  std::string open = text;
  const auto blank = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) open[i] = open[i] == '\n' ? '\n' : ' ';
  };
  for (const Block& b : blocks) blank(b.begin, b.end);
  for (const std::string mark : {"```", "`"}) {
    for (std::size_t begin = open.find(mark); begin != std::string::npos; begin = open.find(mark, begin)) {
      const std::size_t end = open.find(mark, begin + mark.size());
      blank(begin, end == std::string::npos ? open.size() : end + mark.size());
    }
  }
  return open;
}

}  // namespace

std::string refreshed_page(const std::string& text, const fs::path& file) {
  Sources sources;
  CellSpec data;
  std::string out;
  std::size_t done = 0;
  for (const Block& block : blocks_of(text, file.string())) {
    const std::string place = file.string() + ":" + line_text(text, block.begin);
    try {
      out += text.substr(done, block.content - done);
      if (block.word == "table") {
        out += table_text(config::parse<TableSpec>(block.specification, "table"), data, sources);
      } else {
        CellSpec spec = config::parse<CellSpec>(block.specification, block.word);
        spec.results = beside(file, spec.results);
        spec.experiment = beside(file, spec.experiment);
        if (block.word == "data") {
          data = spec;
        } else {
          out += cell_text(merged(data, spec), sources);
        }
      }
    } catch (const InputError& e) {
      throw InputError(place + ": " + e.what());
    }
    done = block.content_end;
  }
  return out + text.substr(done);
}

std::vector<std::string> unsupported_figures(const std::string& text) {
  const std::vector<Block> blocks = blocks_of(text, "page");
  std::string generated;
  bool has_data = false;
  for (const Block& b : blocks) {
    generated += text.substr(b.content, b.content_end - b.content) + '\n';
    has_data = has_data || b.word == "data";
  }
  std::vector<std::string> lines;
  if (!has_data) return lines;
  static const std::regex kNumber(R"([0-9]+(\.[0-9]+)?)");
  std::set<std::string> known{"95"};
  for (std::sregex_iterator it(generated.begin(), generated.end(), kNumber), end; it != end; ++it) {
    known.insert(it->str());
  }
  static const std::regex kFigure(R"(([0-9]+\.[0-9]+)\s?(cm|mm|m|deg|rad|ms|us|s|%)(?![A-Za-z])|([0-9]+)\s?%)");
  const std::string open = open_text(text, blocks);
  for (std::sregex_iterator it(open.begin(), open.end(), kFigure), end; it != end; ++it) {
    const std::string figure = (*it)[1].matched ? (*it)[1] : (*it)[3];
    if (known.contains(figure)) continue;
    lines.push_back(line_text(text, static_cast<std::size_t>(it->position())) + ": " + it->str());
  }
  return lines;
}

}  // namespace noctule::experiment
