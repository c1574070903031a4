#include "eval/landmark_file.hpp"

#include <array>
#include <cmath>
#include <map>

#include "eval/number_rows.hpp"
#include "eval/number_text.hpp"

namespace noctule::eval {

std::vector<KnownLandmark> parse_landmarks(std::string_view text, const std::string& place) {
  constexpr std::array<std::string_view, 3> kColumns{"id", "x", "y"};
  constexpr double kLargestId = 0x1p53;  // integers that a double holds exactly
  std::vector<KnownLandmark> landmarks;
  std::map<std::int64_t, int> line_of_id;
  for (const NumberRow& row : parse_rows(text, place, kColumns, ',')) {
    const double id = row.values[0];
    if (id != std::floor(id) || std::abs(id) > kLargestId) {
      refuse_row(place, row.line, "an integer id", shortest(id));
    }
    const auto number = static_cast<std::int64_t>(id);
    const auto [other, is_new] = line_of_id.try_emplace(number, row.line);
    if (!is_new) {
      refuse_row(place, row.line, "each id once",
                 std::to_string(number) + " as in line " + std::to_string(other->second));
    }
    landmarks.push_back({number, {row.values[1], row.values[2]}});
  }
  return landmarks;
}

std::string landmarks_csv(std::span<const KnownLandmark> landmarks) {
  std::string text = "id,x,y\n";
  for (const KnownLandmark& l : landmarks) {
    text += std::to_string(l.id) + ',' + shortest(l.position.x()) + ',' + shortest(l.position.y()) + '\n';
  }
  return text;
}

}  // namespace noctule::eval
