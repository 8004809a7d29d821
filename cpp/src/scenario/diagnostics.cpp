#include "scenario/diagnostics.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "der/core/printable.hpp"

namespace der::scenario {
namespace {

Path path_to(const Place& place) {
  Path path;
  for (const Place* step = &place; step->parent; step = step->parent) {
    path.push_back(step->index < 0 ? Segment(std::string(step->key)) : Segment(step->index));
  }
  std::reverse(path.begin(), path.end());
  return path;
}

/// The value that a segment names inside another; null if there is none.
const Value* child(const Value& parent, const Segment& segment) {
  if (segment.index >= 0) {
    const Sequence* items = parent.sequence();
    const auto index = static_cast<std::size_t>(segment.index);
    return items && index < items->size() ? &(*items)[index] : nullptr;
  }
  const Mapping* entries = parent.mapping();
  const Entry* entry = entries ? find_entry(*entries, segment.key) : nullptr;
  return entry ? &entry->value : nullptr;
}

/// A list item goes by its name, as in an override, unless an earlier one has the same.
std::string item_text(const Sequence& items, int index) {
  const std::string* name = name_of(items[static_cast<std::size_t>(index)]);
  if (!name || name->empty()) return std::to_string(index);
  const auto end = items.begin() + index;
  const bool taken = std::any_of(items.begin(), end, [&](const Value& earlier) {
    const std::string* other = name_of(earlier);
    return other && *other == *name;
  });
  return taken ? std::to_string(index) : *name;
}

}  // namespace

Path operator/(const Path& path, Segment next) {
  Path longer;
  longer.reserve(path.size() + 1);  // many are made, and few are told
  longer = path;
  longer.push_back(std::move(next));
  return longer;
}

void Diagnostics::add(const Place& place, std::string message) {
  record(path_to(place), place.value->mark, std::move(message));
}

void Diagnostics::add_key(const Place& mapping, std::string_view key, const Mark& mark,
                          std::string message) {
  record(path_to(mapping) / std::string(key), mark, std::move(message));
}

void Diagnostics::add(const Path& path, std::string message) {
  const Value* value = &document_.root();
  for (const Segment& segment : path) {
    const Value* next = child(*value, segment);
    if (!next) break;
    value = next;
  }
  record(path, value->mark, std::move(message));
}

void Diagnostics::note_vector(const Place& place, std::string (*hint)(const Sequence&)) {
  const std::size_t components = place.value->sequence()->size();
  std::optional<FirstVector>& first = vectors_[components - 2];
  if (first) return;
  first = FirstVector{path_to(place), place.value->mark};
  const std::optional<FirstVector>& other = vectors_[3 - components];
  if (!other) return;
  const auto line = [](const Mark& mark) {
    return mark.line > 0 ? fmt::format(" (line {})", mark.line) : std::string();
  };
  const std::string why = hint(*place.value->sequence());
  add(place,
      fmt::format("has {} components, but {}{} has {}: {}", components, written(other->path),
                  line(other->mark), 5 - components,
                  why.empty() ? "all vectors of a scene have three as soon as one has" : why));
}

bool Diagnostics::under(const Path& path) const {
  return std::any_of(found_.begin(), found_.end(), [&](const Found& found) {
    return found.path.size() >= path.size() &&
           std::equal(path.begin(), path.end(), found.path.begin());
  });
}

bool Diagnostics::at(const Path& path) const {
  return std::any_of(found_.begin(), found_.end(),
                     [&](const Found& found) { return found.path == path; });
}

void Diagnostics::throw_if_any() const {
  if (!found_.empty()) throw SceneError(document_.source(), diagnostics());
}

std::vector<Diagnostic> Diagnostics::diagnostics() const {
  std::vector<Diagnostic> diagnostics;
  for (const Found& found : found_) diagnostics.push_back(found.diagnostic);
  std::stable_sort(diagnostics.begin(), diagnostics.end(), [](const auto& a, const auto& b) {
    return std::tie(a.line, a.column) < std::tie(b.line, b.column);
  });
  return diagnostics;
}

void Diagnostics::record(Path path, const Mark& mark, std::string message) {
  if (found_.size() == kMaxDiagnostics) {
    std::vector<Diagnostic> first = diagnostics();
    first.push_back({0, 0, "", "there is more wrong than that; mend these first"});
    throw SceneError(document_.source(), std::move(first));
  }
  std::string text = written(path);
  found_.push_back(
      {std::move(path), {mark.line, mark.column, std::move(text), std::move(message)}});
}

std::string Diagnostics::written(const Path& path) const {
  std::string text;
  const Value* value = &document_.root();
  for (const Segment& segment : path) {
    if (!text.empty()) text += '.';
    const Value* next = value ? child(*value, segment) : nullptr;
    if (segment.index < 0) {
      text += shortened(segment.key);
    } else {
      text += next ? item_text(*value->sequence(), segment.index) : std::to_string(segment.index);
    }
    value = next;
  }
  return text;
}

}  // namespace der::scenario
