#include "experiment/slam_filters.hpp"

#include <algorithm>

#include "config/config.hpp"
#include "core/error.hpp"

namespace noctule::experiment {
namespace {

struct Choice {
  filters::SlamFilterParameters filter;

  template <class Visitor>
  static void describe(Visitor& v) {
    v.one_of("filter", &Choice::filter, filters::kSlamFilterNames, "the filter");
  }
};

}  // namespace

bool is_slam_filter(const std::string& name) {
  return std::ranges::find(filters::kSlamFilterNames, name) != filters::kSlamFilterNames.end();
}

filters::SlamFilterParameters slam_filter_parameters(const FilterSpec& filter) {
  using config::Tree;
  Tree tree = effective_config(filter);
  if (tree.kind == Tree::Kind::nothing) tree.kind = Tree::Kind::map;
  if (const Tree* type = tree.find("type")) {
    if (type->text != filter.name && filter.name != kOracle) {
      throw InputError(to_string(type->place) + ": filter '" + filter.name + "': type: expected " + filter.name +
                       ", got " + config::describe(*type));
    }
  } else if (tree.kind == Tree::Kind::map && filter.name != kOracle) {
    Tree name;
    name.kind = Tree::Kind::scalar;
    name.place = tree.place;
    name.text = filter.name;
    tree.entries.push_back({"type", tree.place, name});
  }
  Tree choice;
  choice.kind = Tree::Kind::map;
  choice.place = tree.place;
  choice.entries.push_back({"filter", tree.place, std::move(tree)});
  return config::load<Choice>(choice).filter;
}

}  // namespace noctule::experiment
