#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "scenario/suggestion.hpp"

namespace der::scenario {

/// The number of what has a name in a list of the scene; nothing if none of its items has it.
template <class Item>
std::optional<int> find_by_name(const std::vector<Item>& items, const std::string& name) {
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const Item& item) { return item.name == name; });
  if (found == items.end()) return std::nullopt;
  return static_cast<int>(found - items.begin());
}

/// `what` is the word for an item: "actuation".
template <class Item>
std::string none_of_that_name(const char* what, const std::vector<Item>& items,
                              const std::string& name) {
  std::vector<std::string> names;
  for (const Item& item : items) {
    if (!item.name.empty()) names.push_back(item.name);
  }
  const std::string near = did_you_mean(name, names);
  return fmt::format("there is no {} '{}'{}", what, name,
                     !near.empty()   ? near
                     : names.empty() ? "; the scene has none with a name"
                                     : "; there is " + listed(names));
}

}  // namespace der::scenario
