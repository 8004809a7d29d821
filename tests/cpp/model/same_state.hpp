#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "der/model/fields.hpp"
#include "der/model/state.hpp"

namespace der::test {

/// All numbers of a struct of fields, bit for bit, each with the name of its field.
template <class Struct>
std::vector<std::pair<std::string, std::uint64_t>> words_of(const Struct& object) {
  std::vector<std::pair<std::string, std::uint64_t>> words;
  for_each_value(object, [&](const auto& field, const auto& value) {
    const auto add = [&](auto number) {
      std::uint64_t word = 0;
      std::memcpy(&word, &number, sizeof number);
      words.emplace_back(field.name, word);
    };
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Vector>) {
      add(std::int64_t{value.size()});
      for (const double entry : value) add(entry);
    } else {
      add(value);
    }
  });
  return words;
}

/// Name of the first field in which two states are not the same, bit for bit; empty: none.
inline std::string first_difference(const State& a, const State& b) {
  const auto left = words_of(a);
  const auto right = words_of(b);
  for (std::size_t i = 0; i < left.size() && i < right.size(); ++i) {
    if (left[i] != right[i]) return left[i].first;
  }
  return left.size() == right.size() ? "" : "size";
}

}  // namespace der::test
