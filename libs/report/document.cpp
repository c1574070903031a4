#include "report/document.hpp"

#include "report/assets.hpp"
#include "report/text.hpp"

namespace noctule::report {

std::string document(const std::string& title, const std::string& header, const std::string& content,
                     const std::string& scripts) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
         escape(title) + " \xC2\xB7 Noctule</title>\n<style>\n" + kFigureStyle + kPageStyle +
         "</style>\n</head>\n<body>\n" + header + "<main>\n" + content + "</main>\n" + scripts + "</body>\n</html>\n";
}

std::string page_header(const std::string& eyebrow, const std::string& title,
                        const std::vector<std::pair<std::string, std::string>>& facts) {
  std::string list;
  for (const auto& [name, value] : facts) {
    if (!value.empty()) list += "<div><dt>" + escape(name) + "</dt><dd>" + escape(value) + "</dd></div>\n";
  }
  return "<header><p class=\"eyebrow\">" + escape(eyebrow) + "</p>\n<h1>" + escape(title) +
         "</h1>\n<dl class=\"facts\">\n" + list + "</dl></header>\n";
}

std::string section(const std::string& heading, const std::string& lead, const std::string& content) {
  if (content.empty()) return {};
  return "<section>\n<h2>" + heading + "</h2>\n" + (lead.empty() ? "" : "<p class=\"lead\">" + lead + "</p>\n") +
         content + "</section>\n";
}

std::string folded(const std::string& summary, const std::string& text) {
  return "<details><summary>" + escape(summary) + "</summary><pre>" + escape(text) + "</pre></details>\n";
}

}  // namespace noctule::report
