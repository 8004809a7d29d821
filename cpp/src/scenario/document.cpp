#include "der/scenario/document.hpp"

#include <algorithm>
#include <utility>

namespace der::scenario {

Value make_null() { return {}; }
Value make_scalar(bool value) { return {value, {}}; }
Value make_scalar(int value) { return {std::int64_t{value}, {}}; }
Value make_scalar(std::int64_t value) { return {value, {}}; }
Value make_scalar(double value) { return {value, {}}; }
Value make_scalar(std::string value) { return {std::move(value), {}}; }
Value make_scalar(const char* value) { return {std::string(value), {}}; }
Value make_sequence(Sequence items) { return {std::move(items), {}}; }
Value make_mapping(Mapping entries) { return {std::move(entries), {}}; }

const Entry* find_entry(const Mapping& mapping, std::string_view key) {
  const auto entry = std::find_if(mapping.begin(), mapping.end(),
                                  [&](const Entry& candidate) { return candidate.key == key; });
  return entry == mapping.end() ? nullptr : &*entry;
}

const std::string* name_of(const Value& item) {
  const Mapping* mapping = item.mapping();
  const Entry* entry = mapping ? find_entry(*mapping, "name") : nullptr;
  if (!entry) return nullptr;
  if (const auto* plain = std::get_if<Plain>(&entry->value.content)) return &plain->text;
  return std::get_if<std::string>(&entry->value.content);
}

}  // namespace der::scenario
