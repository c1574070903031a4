#pragma once
/// What all pages share: one self-contained HTML file. `text` and `content` arguments are markup.
#include <string>
#include <utility>
#include <vector>

namespace noctule::report {

/// The whole page. \param scripts elements behind the content
[[nodiscard]] std::string document(const std::string& title, const std::string& header, const std::string& content,
                                   const std::string& scripts = {});
/// Title above a row of names with their values; empty values are left out. Escapes all of them.
[[nodiscard]] std::string page_header(const std::string& eyebrow, const std::string& title,
                                      const std::vector<std::pair<std::string, std::string>>& facts);
/// Empty without content. \param lead a sentence below the heading, or nothing
[[nodiscard]] std::string section(const std::string& heading, const std::string& lead, const std::string& content);
/// A text behind a summary that opens it. Escapes both.
[[nodiscard]] std::string folded(const std::string& summary, const std::string& text);

}  // namespace noctule::report
