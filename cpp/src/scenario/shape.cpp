#include "scenario/shape.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenario/suggestion.hpp"

namespace der::scenario {
namespace {

std::string with_unit(const std::string& text, const Shape& shape) {
  return shape.unit.empty() ? text : text + " in " + shape.unit;
}

std::string expected_one_of(const std::vector<Shape>& parts) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) text += i + 1 == parts.size() ? " or " : ", ";
    text += expected(parts[i]);
  }
  return text;
}

}  // namespace

std::vector<std::string> TableInfo::keys() const {
  std::vector<std::string> keys;
  keys.reserve(fields.size());
  for (const FieldInfo& field : fields) keys.push_back(field.key);
  return keys;
}

std::vector<std::string> TableInfo::kinds() const {
  std::vector<std::string> kinds;
  for (const FieldInfo& field : fields) {
    if (field.is_kind) kinds.push_back(field.key);
  }
  return kinds;
}

std::string TableInfo::unit_of(const FieldInfo& field) const {
  constexpr std::array of_the_key{"values", "amplitude", "offset"};
  const bool follows = unit_of_the_key && std::find(of_the_key.begin(), of_the_key.end(),
                                                    field.key) != of_the_key.end();
  return follows ? "of the key" : field.shape.unit;
}

int TableInfo::find(std::string_view key) const {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (fields[i].key == key) return static_cast<int>(i);
  }
  return -1;
}

std::string expected_mapping(const TableInfo& table) {
  if (table.one_key && table.fields.size() > 1) {
    return "a mapping with one of the keys " + listed(table.kinds(), " or ");
  }
  return fmt::format("a mapping with the key{} {}", table.fields.size() == 1 ? "" : "s",
                     listed(table.keys()));
}

std::string expected(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::Number:
      return with_unit("a number", shape);
    case Shape::Kind::Integer:
      return "a whole number";
    case Shape::Kind::Boolean:
      return "true or false";
    case Shape::Kind::Text:
      return "a text";
    case Shape::Kind::Name:
      return "a name";
    case Shape::Kind::Choice:
      return listed(names_of(shape.words), " or ");
    case Shape::Kind::Vector:
      return with_unit(shape.min_items == 3 ? "a vector [x, y, z]" : "a vector [x, y] or [x, y, z]",
                       shape);
    case Shape::Kind::Pair:
      return with_unit("a pair [k1, k2]", shape);
    case Shape::Kind::Triple:
      return with_unit("a list [k1, k2, kt]", shape);
    case Shape::Kind::List:
      return "a list";
    case Shape::Kind::Table:
      return expected_mapping(*shape.table);
    case Shape::Kind::NamedTables:
      return "a mapping from names to " + shape.table->name + "s";
    case Shape::Kind::AnyOf:
      return expected_one_of(shape.parts);
  }
  return {};
}

std::string bounds(const Range& range) {
  const bool below = std::isfinite(range.min);
  const bool above = std::isfinite(range.max);
  if (below && above) {
    return fmt::format("between {} and {}{}", range.min, range.max,
                       range.min_open && range.max_open ? " (both excluded)" : "");
  }
  if (below) return fmt::format("{} {}", range.min_open ? "greater than" : "at least", range.min);
  if (above) return fmt::format("{} {}", range.max_open ? "less than" : "at most", range.max);
  return {};
}

std::vector<std::string> names_of(const std::vector<Word>& words) {
  std::vector<std::string> names;
  names.reserve(words.size());
  for (const Word& word : words) names.push_back(word.name);
  return names;
}

bool is_name(std::string_view text) {
  const auto is_letter = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
  };
  return !text.empty() && is_letter(text.front()) &&
         std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-'; });
}

}  // namespace der::scenario
