#include "scenario/overrides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <utility>

#include "der/scenario/value_override.hpp"
#include "scenario/suggestion.hpp"

namespace der::scenario {
namespace {

/// An override that leads nowhere, and why.
struct Astray {
  std::string message;
};

std::vector<std::string> segments_of(const std::string& path) {
  std::vector<std::string> segments;
  std::size_t start = 0;
  while (true) {
    const std::size_t dot = path.find('.', start);
    segments.push_back(path.substr(start, dot - start));
    if (segments.back().empty())
      throw Astray{"a path is made of keys and items joined by single dots"};
    if (dot == std::string::npos) return segments;
    start = dot + 1;
  }
}

std::optional<std::size_t> index_of(const std::string& segment) {
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(segment.data(), segment.data() + segment.size(), index);
  if (error != std::errc{} || end != segment.data() + segment.size()) return std::nullopt;
  return index;
}

/// Position of the item that a segment names, by number or by `name`; `where()` says in words what
/// the items are those of.
template <class Where>
std::size_t item_index(const Sequence& items, const std::string& segment, const Where& where) {
  if (const auto index = index_of(segment)) {
    if (*index < items.size()) return *index;
    throw Astray{items.empty() ? fmt::format("{} is empty", where())
                               : fmt::format("{} has the items 0 to {}, but no item {}", where(),
                                             items.size() - 1, *index)};
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string* name = name_of(items[i]);
    if (!name) continue;
    if (*name == segment) return i;
    names.push_back(*name);
  }
  std::string hint = did_you_mean(segment, names);
  if (hint.empty()) {
    hint = names.empty() ? "; name its items by number" : "; it has " + listed(names);
  }
  throw Astray{fmt::format("{} has no item '{}'{}", where(), segment, hint)};
}

/// Takes the marks of another text off a value.
void unmark(Value& value) {
  value.mark = {};
  if (auto* items = std::get_if<Sequence>(&value.content)) {
    for (Value& item : *items) unmark(item);
  } else if (auto* entries = std::get_if<Mapping>(&value.content)) {
    for (Entry& entry : *entries) {
      entry.mark = {};
      unmark(entry.value);
    }
  }
}

Value parsed_value(const std::string& text) {
  try {
    Value value = Document::parse(text, "").root();
    unmark(value);
    return value;
  } catch (const SceneError& error) {
    throw Astray{fmt::format("the value '{}' cannot be read: {}", text,
                             error.diagnostics().front().message)};
  }
}

/// Walks down one path and changes what it finds at the end.
class Change {
 public:
  Change(const std::string& path, Value value)
      : segments_(segments_of(path)), value_(std::move(value)) {}

  void apply(Value& root) { descend(root, 0); }

 private:
  void descend(Value& here, std::size_t depth) {
    const std::string& segment = segments_[depth];
    const bool last = depth + 1 == segments_.size();
    if (auto* items = std::get_if<Sequence>(&here.content)) {
      const std::size_t index = item_index(*items, segment, [&] { return where(depth); });
      if (!last) return descend((*items)[index], depth + 1);
      if (!value_.is_null()) {
        (*items)[index] = std::move(value_);
      } else {
        items->erase(items->begin() + static_cast<std::ptrdiff_t>(index));
      }
    } else if (auto* entries = std::get_if<Mapping>(&here.content)) {
      Entry* entry = const_entry(*entries, segment);
      if (!entry) entry = &added(*entries, segment, depth);
      if (!last) return descend(entry->value, depth + 1);
      if (!value_.is_null()) {
        entry->value = std::move(value_);
      } else {
        entries->erase(entries->begin() + (entry - entries->data()));
      }
    } else {
      throw Astray{
          fmt::format("{} is a single value and has no '{}' in it", where(depth), segment)};
    }
  }

  /// The path as far as it has been walked, in quotes.
  [[nodiscard]] std::string where(std::size_t depth) const {
    if (depth == 0) return "the scene";
    return fmt::format(
        "'{}'",
        fmt::join(segments_.begin(), segments_.begin() + static_cast<std::ptrdiff_t>(depth), "."));
  }

  static Entry* const_entry(Mapping& entries, const std::string& key) {
    const auto found = std::find_if(entries.begin(), entries.end(),
                                    [&](const Entry& entry) { return entry.key == key; });
    return found == entries.end() ? nullptr : &*found;
  }

  /// A key that the scene leaves to its default so far; whether there is such a key is for the
  /// reader to say.
  Entry& added(Mapping& entries, const std::string& key, std::size_t depth) const {
    const bool last = depth + 1 == segments_.size();
    const bool item_follows = !last && index_of(segments_[depth + 1]);
    if ((last && value_.is_null()) || item_follows) {
      std::vector<std::string> keys;
      for (const Entry& entry : entries) keys.push_back(entry.key);
      const std::string near = did_you_mean(key, keys);
      throw Astray{fmt::format("{} has no '{}'{}", where(depth), key,
                               near.empty() && !keys.empty() ? "; it has " + listed(keys) : near)};
    }
    entries.push_back({key, make_mapping({}), {}});
    return entries.back();
  }

  std::vector<std::string> segments_;
  Value value_;
};

Value as_value(const Value& value) { return value; }
Value as_value(const std::string& text) { return parsed_value(text); }

template <class New>
Document with_changes(const Document& document,
                      const std::vector<std::pair<std::string, New>>& overrides) {
  Value root = document.root();
  std::vector<Diagnostic> astray;
  for (const auto& [path, value] : overrides) {
    try {
      Change(path, as_value(value)).apply(root);
    } catch (const Astray& error) {
      astray.push_back({0, 0, path, error.message});
    }
  }
  if (!astray.empty()) throw SceneError(document.source(), std::move(astray));
  return Document(std::move(root), document.source());
}

}  // namespace

Document with_overrides(const Document& document, const std::vector<Override>& overrides) {
  return with_changes(document, overrides);
}

}  // namespace der::scenario

namespace der {

Scenario with_values(const Scenario& scenario, const std::vector<ValueOverride>& values) {
  return Scenario::from_document(std::make_shared<const scenario::Document>(
      scenario::with_changes(scenario.document(), values)));
}

}  // namespace der
