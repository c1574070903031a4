#include <charconv>
#include <cmath>
#include <map>
#include <type_traits>

#include "config/config.hpp"
#include "config/keys.hpp"
#include "config/list_of.hpp"
#include "config/number.hpp"
#include "config/ranges.hpp"

namespace noctule::config {
namespace {

class Reader {
 public:
  void read_group(const Group& group, const Tree& tree, const std::string& path) {
    if (tree.kind != Tree::Kind::map && tree.kind != Tree::Kind::nothing) {
      return problem(tree.place, path, "expected a map of keys", tree);
    }
    const std::size_t problems_before = problems.size();
    std::map<std::string, const Entry*> seen;
    for (const Entry& entry : tree.entries) {
      const auto [first, fresh] = seen.emplace(entry.key, &entry);
      if (!fresh) {
        problems.add(entry.place, path,
                     "duplicate key '" + entry.key + "', first in " + to_string(first->second->place));
        continue;
      }
      read_entry(group, entry, path);
    }
    if (problems.size() > problems_before) return;  // a check across fields would only repeat them
    if (const std::string text = group.validate(); !text.empty()) problems.add(tree.place, path, text);
  }

  Problems problems;

 private:
  static std::string join(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
  }

  void problem(const Place& place, const std::string& path, const std::string& expected, const Tree& got) {
    problems.add(place, path, expected + ", got " + describe(got));
  }

  void read_entry(const Group& group, const Entry& entry, const std::string& path) {
    for (const Field& field : group.fields) {
      if (field.key == entry.key) {
        field_ = &field;
        return std::visit([&](auto& target) { read_value(target, entry.value, join(path, entry.key)); }, field.target);
      }
    }
    problems.add(entry.place, path, unknown_key(entry.key, group.fields));
  }

  void read_value(bool* target, const Tree& tree, const std::string& path) {
    const bool plain = tree.kind == Tree::Kind::scalar && !tree.quoted;
    if (plain && tree.text == "true") {
      *target = true;
    } else if (plain && tree.text == "false") {
      *target = false;
    } else {
      problem(tree.place, path, "expected true or false", tree);
    }
  }

  template <class Integer>
  requires std::is_integral_v<Integer>
  void read_value(Integer* target, const Tree& tree, const std::string& path) {
    const std::string expected =
        expectation(std::is_signed_v<Integer> || field_->range.min > 0 ? "an integer" : "an integer >= 0");
    if (tree.kind != Tree::Kind::scalar || tree.quoted) return problem(tree.place, path, expected, tree);
    std::string_view text = tree.text;
    if (text.starts_with('+')) text.remove_prefix(1);
    Integer value{};
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (stop != text.data() + text.size() || error == std::errc::invalid_argument) {
      return problem(tree.place, path, expected, tree);
    }
    if (error == std::errc::result_out_of_range) {
      return problem(tree.place, path, expected + " of " + std::to_string(8 * sizeof(Integer)) + " bits", tree);
    }
    if (!contains(field_->range, static_cast<double>(value))) return problem(tree.place, path, expected, tree);
    *target = value;
  }

  void read_value(double* target, const Tree& tree, const std::string& path) {
    read_number(*target, field_->unit, tree, path);
  }

  void read_value(std::string* target, const Tree& tree, const std::string& path) {
    if (tree.kind != Tree::Kind::scalar) return problem(tree.place, path, "expected a text", tree);
    *target = tree.text;
  }

  void read_value(std::filesystem::path* target, const Tree& tree, const std::string& path) {
    if (tree.kind != Tree::Kind::scalar) return problem(tree.place, path, "expected a path", tree);
    // Absolute, so that the effective configuration can be used from anywhere; relative to the file that says it.
    const std::filesystem::path directory = tree.place.source ? tree.place.source->directory : "";
    *target = tree.text.empty() ? "" : std::filesystem::absolute(directory / tree.text).lexically_normal();
  }

  void read_value(Vector2* target, const Tree& tree, const std::string& path) { read_vector(*target, tree, path); }

  void read_value(Pose2* target, const Tree& tree, const std::string& path) {
    if (!is_list_of(tree, 3))
      return problem(tree.place, path, std::string("expected a pose [x, y, yaw] in ") + field_->unit.symbol, tree);
    const Unit length{field_->unit.to_si == unit::centimetre.to_si ? "cm" : "m", field_->unit.to_si};
    const Unit angle{"deg", unit::degree.to_si};
    read_number(target->x, length, tree.items[0], path + "[0]");
    read_number(target->y, length, tree.items[1], path + "[1]");
    read_number(target->yaw, angle, tree.items[2], path + "[2]");
  }

  void read_value(std::vector<double>* target, const Tree& tree, const std::string& path) {
    if (tree.kind != Tree::Kind::list) return problem(tree.place, path, "expected a list of numbers", tree);
    target->assign(tree.items.size(), 0.0);
    for (std::size_t i = 0; i < tree.items.size(); ++i)
      read_number((*target)[i], field_->unit, tree.items[i], item(path, i));
  }

  void read_value(std::vector<std::string>* target, const Tree& tree, const std::string& path) {
    if (tree.kind != Tree::Kind::list) return problem(tree.place, path, "expected a list of texts", tree);
    target->assign(tree.items.size(), "");
    for (std::size_t i = 0; i < tree.items.size(); ++i) read_value(&(*target)[i], tree.items[i], item(path, i));
  }

  void read_value(Tree* target, const Tree& tree, const std::string&) { *target = tree; }

  void read_value(std::vector<Vector2>* target, const Tree& tree, const std::string& path) {
    if (tree.kind != Tree::Kind::list) return problem(tree.place, path, "expected a list of [x, y]", tree);
    target->assign(tree.items.size(), Vector2::Zero());
    for (std::size_t i = 0; i < tree.items.size(); ++i) read_vector((*target)[i], tree.items[i], item(path, i));
  }

  void read_value(const OneOf& one, const Tree& tree, const std::string& path) {
    const std::string expected = "expected one of " + list_of(one.names);
    const Tree* type = tree.find("type");
    if (type == nullptr)
      return problem(tree.place, path, "expected a map with the key 'type' (one of " + list_of(one.names) + ")", tree);
    const auto name = std::find(one.names.begin(), one.names.end(), type->text);
    if (name == one.names.end()) return problem(type->place, path + ".type", expected, *type);
    read_group(one.value(static_cast<std::size_t>(name - one.names.begin())), tree, path);
  }

  void read_value(const Choice& choice, const Tree& tree, const std::string& path) {
    const auto name = std::find(choice.names.begin(), choice.names.end(), tree.text);
    if (tree.kind == Tree::Kind::scalar && name != choice.names.end()) {
      return choice.set(static_cast<std::size_t>(name - choice.names.begin()));
    }
    problem(tree.place, path, "expected one of " + list_of(choice.names), tree);
  }

  void read_value(const Group& group, const Tree& tree, const std::string& path) { read_group(group, tree, path); }

  void read_value(const OptionalGroup& group, const Tree& tree, const std::string& path) {
    read_group(group.value(), tree, path);
  }

  void read_value(const List& list, const Tree& tree, const std::string& path) {
    if (tree.kind != Tree::Kind::list) return problem(tree.place, path, "expected a list of maps", tree);
    list.resize(tree.items.size());
    for (std::size_t i = 0; i < tree.items.size(); ++i) read_group(list.item(i), tree.items[i], item(path, i));
  }

  void read_vector(Vector2& target, const Tree& tree, const std::string& path) {
    if (!is_list_of(tree, 2))
      return problem(tree.place, path, std::string("expected a point [x, y] in ") + field_->unit.symbol, tree);
    read_number(target.x(), field_->unit, tree.items[0], path + "[0]");
    read_number(target.y(), field_->unit, tree.items[1], path + "[1]");
  }

  void read_number(double& target, const Unit& in, const Tree& tree, const std::string& path) {
    std::string expected = expectation("a number");
    if (std::string_view(in.symbol) != unit::one.symbol) expected += std::string(" in ") + in.symbol;
    if (tree.kind != Tree::Kind::scalar || tree.quoted) return problem(tree.place, path, expected, tree);
    const auto number = parse_number(tree.text, in.to_si);
    if (!number) return problem(tree.place, path, expected, tree);
    if (!std::isfinite(number->written)) return problem(tree.place, path, "expected a finite number", tree);
    if (!contains(field_->range, number->written)) return problem(tree.place, path, expected, tree);
    target = number->si;
  }

  [[nodiscard]] std::string expectation(const std::string& what) const {
    const std::string range = to_string(field_->range);
    return "expected " + what + (range.empty() ? "" : " " + range);
  }

  static bool is_list_of(const Tree& tree, std::size_t n) {
    return tree.kind == Tree::Kind::list && tree.items.size() == n;
  }
  static std::string item(const std::string& path, std::size_t i) { return path + "[" + std::to_string(i) + "]"; }

  const Field* field_ = nullptr;  ///< whose value is being read; set before each
};

}  // namespace

void read(const Group& group, const Tree& tree) {
  Reader reader;
  reader.read_group(group, tree, "");
  reader.problems.throw_if_any();
}

}  // namespace noctule::config
