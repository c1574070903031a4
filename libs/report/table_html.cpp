#include "report/table_html.hpp"

#include "report/text.hpp"

namespace noctule::report {
namespace {

std::string css(const std::string& name) {
  return name.empty() ? "" : " class=\"" + name + "\"";
}

std::string span(const char* what, int count) {
  return count > 1 ? std::string(" ") + what + "=\"" + std::to_string(count) + "\"" : "";
}

}  // namespace

std::string table(const std::string& caption, const std::string& head, const std::string& body,
                  const std::string& css_class) {
  return "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + caption + "\">\n<table" +
         css(css_class) + "><caption>" + caption + "</caption>\n<thead>" + head + "</thead>\n<tbody>\n" + body +
         "</tbody></table></div>\n";
}

std::string cell(const std::string& text, const std::string& css_class, int columns) {
  return "<td" + css(css_class) + span("colspan", columns) + ">" + text + "</td>";
}

std::string row_head(const std::string& text, int rows) {
  return "<th scope=\"row\"" + span("rowspan", rows) + ">" + text + "</th>";
}

std::string column_head(const std::string& text, const std::string& css_class, int columns, int rows) {
  return "<th scope=\"" + std::string(columns > 1 ? "colgroup" : "col") + "\"" + css(css_class) +
         span("colspan", columns) + span("rowspan", rows) + ">" + text + "</th>";
}

std::string head_row(const std::vector<std::string>& texts) {
  std::string cells;
  for (const std::string& t : texts) cells += column_head(t);
  return row(cells);
}

std::string row(const std::string& cells, const std::string& css_class) {
  return "<tr" + css(css_class) + ">" + cells + "</tr>\n";
}

std::string value_with_error(double value, double error) {
  return aligned(value) + "<small>" + (error > 0.0 ? "+" : "") + aligned(error) + "</small>";
}

}  // namespace noctule::report
