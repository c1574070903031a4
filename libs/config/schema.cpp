#include "config/schema.hpp"

namespace noctule::config {

void FieldCollector::add(const char* key, const char* doc, const Unit& unit, const Range& range, Target&& target) {
  fields_.push_back({key, doc, unit, range, std::move(target)});
}

Group FieldCollector::with_type(Group group, const std::vector<std::string>& names, std::size_t i, const char* doc) {
  Choice type{names, [i] { return i; }, [](std::size_t) {}};
  group.fields.insert(group.fields.begin(), {"type", doc, unit::one, {}, std::move(type)});
  return group;
}

}  // namespace noctule::config
