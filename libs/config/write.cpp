#include <algorithm>
#include <array>
#include <cctype>

#include "config/config.hpp"
#include "config/list_of.hpp"
#include "config/number.hpp"
#include "config/ranges.hpp"

namespace noctule::config {
namespace {

/// \param plain_allowed without quotes where nothing is lost by it
std::string quoted(const std::string& text, bool plain_allowed = true) {
  static constexpr std::array kReserved{"null", "Null", "NULL"};
  const bool plain =
      plain_allowed && !text.empty() && std::isalpha(static_cast<unsigned char>(text.front())) != 0 &&
      std::ranges::all_of(text,
                          [](unsigned char c) {
                            return c < 0x80 && (std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.' || c == '/');
                          }) &&
      std::ranges::find(kReserved, text) == kReserved.end();
  if (plain) return text;
  static constexpr std::string_view kHex = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') out += '\\';
    if (byte < 0x20 || byte == 0x7f) {
      out += {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string flow(const Vector2& v, const Unit& unit) {
  return "[" + print_number(v.x(), unit.to_si) + ", " + print_number(v.y(), unit.to_si) + "]";
}

/// A tree on one line.
std::string flow(const Tree& tree) {
  std::string out;
  switch (tree.kind) {
    case Tree::Kind::nothing:
      return "null";
    case Tree::Kind::scalar:
      return !tree.quoted && parse_number(tree.text, 1.0) ? tree.text : quoted(tree.text, !tree.quoted);
    case Tree::Kind::list:
      for (const Tree& item : tree.items) out += (out.empty() ? "" : ", ") + flow(item);
      return "[" + out + "]";
    case Tree::Kind::map:
      break;
  }
  for (const Entry& entry : tree.entries) {
    out += (out.empty() ? "" : ", ") + quoted(entry.key) + ": " + flow(entry.value);
  }
  return "{" + out + "}";
}

/// The entries of a map, one a line.
void write_block(const Tree& map, std::size_t indent, std::string& out) {
  for (const Entry& entry : map.entries) {
    const bool nested = !entry.value.entries.empty();
    out += std::string(indent, ' ') + quoted(entry.key) + ":" + (nested ? "" : " " + flow(entry.value)) + "\n";
    if (nested) write_block(entry.value, indent + 2, out);
  }
}

/// The value of a leaf on one line.
struct Leaf {
  const Unit& unit;

  std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
  std::string operator()(const int* v) const { return std::to_string(*v); }
  std::string operator()(const std::int64_t* v) const { return std::to_string(*v); }
  std::string operator()(const std::uint64_t* v) const { return std::to_string(*v); }
  std::string operator()(const double* v) const { return print_number(*v, unit.to_si); }
  std::string operator()(const std::string* v) const { return quoted(*v); }
  std::string operator()(const std::filesystem::path* v) const { return quoted(v->string()); }
  std::string operator()(const Vector2* v) const { return flow(*v, unit); }
  std::string operator()(const Pose2* v) const {
    return "[" + print_number(v->x, unit.to_si) + ", " + print_number(v->y, unit.to_si) + ", " +
           print_number(v->yaw, unit::degree.to_si) + "]";
  }
  std::string operator()(const std::vector<double>* v) const {
    return join(*v, [&](double x) { return print_number(x, unit.to_si); });
  }
  std::string operator()(const std::vector<std::string>* v) const {
    return join(*v, [](const std::string& text) { return quoted(text); });
  }
  std::string operator()(const Tree* v) const { return v->entries.empty() ? flow(*v) : ""; }
  std::string operator()(const std::vector<Vector2>* v) const {
    return join(*v, [&](const Vector2& x) { return flow(x, unit); });
  }
  std::string operator()(const Choice& choice) const { return choice.names.at(choice.get()); }
  std::string operator()(const Group&) const { return ""; }
  std::string operator()(const OptionalGroup&) const { return ""; }
  std::string operator()(const OneOf&) const { return ""; }
  std::string operator()(const List& list) const { return list.size() == 0 ? "[]" : ""; }

 private:
  template <class Element, class Print>
  static std::string join(const std::vector<Element>& v, const Print& print) {
    std::string out = "[";
    for (std::size_t i = 0; i < v.size(); ++i) out += (i == 0 ? "" : ", ") + print(v[i]);
    return out + "]";
  }
};

std::string allowed_values(const Field& field) {
  if (const auto* choice = std::get_if<Choice>(&field.target)) return "one of " + list_of(choice->names);
  return to_string(field.range);
}

bool has_unit(const Field& field) {
  return std::string_view(field.unit.symbol) != unit::one.symbol;
}

std::string comment(const Field& field) {
  std::string text = "  # " + field.doc;
  if (has_unit(field)) text += std::string(" [") + field.unit.symbol + "]";
  const std::string allowed = allowed_values(field);
  return allowed.empty() ? text : text + "; " + allowed;
}

void write_group(const Group& group, std::size_t indent, std::string first_prefix, std::string& out) {
  const std::string prefix(indent, ' ');
  for (const Field& field : group.fields) {
    const auto* optional = std::get_if<OptionalGroup>(&field.target);
    if (optional != nullptr && !optional->present()) continue;
    const std::string value = std::visit(Leaf{field.unit}, field.target);
    out += (first_prefix.empty() ? prefix : std::exchange(first_prefix, "")) + field.key + ":" +
           (value.empty() ? "" : " " + value) + comment(field) + "\n";
    if (const auto* nested = std::get_if<Group>(&field.target)) write_group(*nested, indent + 2, "", out);
    if (const auto* tree = std::get_if<Tree*>(&field.target)) write_block(**tree, indent + 2, out);
    if (const auto* one = std::get_if<OneOf>(&field.target)) {
      write_group(one->value(one->index()), indent + 2, "", out);
    }
    if (optional != nullptr) write_group(optional->value(), indent + 2, "", out);
    if (const auto* list = std::get_if<List>(&field.target)) {
      for (std::size_t i = 0; i < list->size(); ++i) {
        write_group(list->item(i), indent + 4, prefix + "  - ", out);
      }
    }
  }
  if (!first_prefix.empty()) out += first_prefix + "{}\n";  // an item of a list without any keys
}

std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

void document_group(const Group& group, const std::string& path, std::string& out) {
  for (const Field& field : group.fields) {
    const std::string key = path.empty() ? field.key : path + "." + field.key;
    if (const auto* nested = std::get_if<Group>(&field.target)) {
      document_group(*nested, key, out);
    } else if (const auto* optional = std::get_if<OptionalGroup>(&field.target)) {
      document_group(optional->prototype(), key, out);
    } else if (const auto* list = std::get_if<List>(&field.target)) {
      document_group(list->prototype(), key + "[]", out);
    } else if (const auto* one = std::get_if<OneOf>(&field.target)) {
      for (std::size_t i = 0; i < one->names.size(); ++i) {
        document_group(one->prototype(i), key + "<" + one->names[i] + ">", out);
      }
    } else {
      out += "| `" + key + "` | " + (has_unit(field) ? field.unit.symbol : "") + " | `" +
             cell(std::visit(Leaf{field.unit}, field.target)) + "` | " + cell(allowed_values(field)) + " | " +
             cell(field.doc) + " |\n";
    }
  }
}

}  // namespace

std::string write(const Group& group) {
  std::string out;
  write_group(group, 0, "", out);
  return out;
}

std::string document(const Group& group) {
  std::string out = "| key | unit | default | allowed | meaning |\n|---|---|---|---|---|\n";
  document_group(group, "", out);
  return out;
}

}  // namespace noctule::config
