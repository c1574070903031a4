#include "config/problems.hpp"

#include "core/error.hpp"

namespace noctule::config {

std::string to_string(const Place& place) {
  const std::string name = place.source ? place.source->name : "<text>";
  return place.line > 0 ? name + ":" + std::to_string(place.line) : name;
}

void Problems::add(const Place& place, const std::string& key, const std::string& text) {
  lines_.push_back(to_string(place) + ": " + (key.empty() ? "" : key + ": ") + text);
}

void Problems::throw_if_any() const {
  if (lines_.empty()) return;
  std::string all = lines_.front();
  for (std::size_t i = 1; i < lines_.size(); ++i) all += "\n" + lines_[i];
  throw InputError(all);
}

}  // namespace noctule::config
