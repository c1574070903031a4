#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "experiment/result_table.hpp"

namespace noctule::experiment {
namespace {

/// Markup of LaTeX escaped, and the few signs beyond ASCII that tables have.
std::string escaped(const std::string& text) {
  static constexpr std::array<std::pair<const char*, const char*>, 17> kSigns{{{"\\", "\\textbackslash{}"},
                                                                               {"_", "\\_"},
                                                                               {"%", "\\%"},
                                                                               {"&", "\\&"},
                                                                               {"#", "\\#"},
                                                                               {"$", "\\$"},
                                                                               {"{", "\\{"},
                                                                               {"}", "\\}"},
                                                                               {"~", "\\textasciitilde{}"},
                                                                               {"^", "\\textasciicircum{}"},
                                                                               {"<", "$<$"},
                                                                               {">", "$>$"},
                                                                               {"\xE2\x88\x92", "$-$"},
                                                                               {"\xE2\x80\x94", "--"},
                                                                               {"\xC2\xB0", "$^\\circ$"},
                                                                               {"\xC2\xB5", "\\textmu{}"},
                                                                               {"\xC3\x97", "$\\times$"}}};
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    bool replaced = false;
    for (const auto& [sign, latex] : kSigns) {
      const std::string_view s(sign);
      if (text.compare(i, s.size(), s) != 0) continue;
      out += latex;
      i += s.size();
      replaced = true;
      break;
    }
    if (!replaced) out += text[i++];
  }
  return out;
}

std::string with_detail(const std::string& text, const std::string& detail) {
  if (detail.empty()) return escaped(text);
  return escaped(text) + " {\\scriptsize " + escaped(detail) + "}";
}

}  // namespace

std::string to_latex(const ResultTable& table, const std::string& label) {
  std::string out = "\\begin{table}\n\\centering\n\\caption{" + escaped(table.caption) + "}\n\\label{" + label +
                    "}\n\\begin{tabular}{l" + std::string(table.columns.size(), 'r') + "}\n\\toprule\n" +
                    escaped(table.corner);
  for (const TableColumn& c : table.columns) out += " & " + with_detail(c.title, c.detail);
  out += " \\\\\n\\midrule\n";
  for (const TableRow& r : table.rows) {
    out += escaped(r.title);
    for (const TableCell& c : r.cells) out += " & " + with_detail(c.value, c.detail);
    out += " \\\\\n";
  }
  return out + "\\bottomrule\n\\end{tabular}\n\\end{table}\n";
}

}  // namespace noctule::experiment
