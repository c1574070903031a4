#include "config/keys.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "config/list_of.hpp"

namespace noctule::config {
namespace {

/// Longest first: `_m_per_s` ends in `_s` too.
constexpr std::array<std::string_view, 19> kUnitSuffixes{"_rad_per_sqrt_m",
                                                         "_deg_per_sqrt_m",
                                                         "_rad_per_s",
                                                         "_deg_per_s",
                                                         "_cm_per_s",
                                                         "_m_per_s",
                                                         "_percent",
                                                         "_cm_deg",
                                                         "_m_deg",
                                                         "_khz",
                                                         "_deg",
                                                         "_rad",
                                                         "_cm",
                                                         "_mm",
                                                         "_hz",
                                                         "_ms",
                                                         "_us",
                                                         "_m",
                                                         "_s"};

std::string_view without_unit(std::string_view key) {
  for (const std::string_view suffix : kUnitSuffixes) {
    if (key.ends_with(suffix)) return key.substr(0, key.size() - suffix.size());
  }
  return key;
}

/// Levenshtein distance in which swapped neighbours count once (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0u);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0u : 1u)});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = std::exchange(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string unknown_key(std::string_view key, const std::vector<Field>& known) {
  const std::string unknown = "unknown key '" + std::string(key) + "'";
  for (const Field& field : known) {
    if (without_unit(field.key) == without_unit(key)) {
      const bool has_unit = without_unit(field.key) != field.key;
      return unknown + (has_unit ? ", wrong unit: expected '" + field.key + "' in " + field.unit.symbol
                                 : ", expected '" + field.key + "' (it has no unit)");
    }
  }
  const Field* nearest = nullptr;
  std::size_t least = std::max<std::size_t>(1, key.size() / 3) + 1;
  for (const Field& field : known) {
    const std::size_t distance = edit_distance(key, field.key);
    if (distance < least) {
      least = distance;
      nearest = &field;
    }
  }
  if (nearest != nullptr) return unknown + ", did you mean '" + nearest->key + "'?";
  std::vector<std::string> names;
  for (const Field& field : known) names.push_back(field.key);
  return unknown + (names.empty() ? ", no keys are known here" : ", known are: " + list_of(names));
}

}  // namespace noctule::config
