#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "der/core/types.hpp"

namespace der {

// All saved data of a run are visited through lists of fields: a struct names its own in
// `static constexpr auto fields()`, once, and checkpoints, checksums, pickles, checks and tests go
// through that list. A field is a number, a Vector, a struct with fields of its own, a std::vector
// of such (a list), or a std::variant of such (an alternative).

/// How many entries a Vector or a list has in a given model or run.
enum class Extent {
  Any,       ///< as many as there are
  Dofs,      ///< one a degree of freedom
  Followed,  ///< what the model follows (model/followed.hpp)
  Probes,    ///< one a probe
};

/// The range of numbers that a run can reach, or a program can write.
enum class Values {
  Any,
  Finite,
  NotNegative,  ///< and finite
};

/// One member of a struct that is saved.
template <class Owner, class Value>
struct Field {
  const char* name;
  const char* unit;
  Value Owner::* member;
  Values values;
  Extent extent;
};

template <class Owner, class Value>
constexpr Field<Owner, Value> field(const char* name, const char* unit, Value Owner::* member,
                                    Values values = Values::Any, Extent extent = Extent::Any) {
  return {name, unit, member, values, extent};
}

template <class T, class = void>
struct HasFields : std::false_type {};
template <class T>
struct HasFields<T, std::void_t<decltype(T::fields())>> : std::true_type {};

template <class T>
struct IsList : std::false_type {};
template <class T>
struct IsList<std::vector<T>> : HasFields<T> {};

template <class T>
struct IsVariant : std::false_type {};
template <class... T>
struct IsVariant<std::variant<T...>> : std::true_type {};

/// Calls `visit(field, value)` for each field of a struct, in the order of its list.
template <class Struct, class Visitor>
void for_each_field(Struct& object, Visitor&& visit) {
  std::apply([&](const auto&... f) { (visit(f, object.*f.member), ...); },
             std::remove_const_t<Struct>::fields());
}

/// Calls `visit(field, value)` for every number and Vector in a struct, depth first. Before those
/// of a list comes its length, and before those of an alternative its number, as std::int64_t.
template <class Struct, class Visitor>
void for_each_value(const Struct& object, Visitor&& visit) {
  for_each_field(object, [&](const auto& field, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (HasFields<Value>::value) {
      for_each_value(value, visit);
    } else if constexpr (IsList<Value>::value) {
      visit(field, static_cast<std::int64_t>(value.size()));
      for (const auto& item : value) for_each_value(item, visit);
    } else if constexpr (IsVariant<Value>::value) {
      visit(field, static_cast<std::int64_t>(value.index()));
      std::visit([&](const auto& held) { for_each_value(held, visit); }, value);
    } else {
      visit(field, value);
    }
  });
}

/// Makes a default value of alternative `number` in place of what a variant holds; false, and
/// nothing is done, where it has none of that number.
template <class... T>
bool emplace_alternative(std::variant<T...>& variant, std::int64_t number) {
  std::int64_t next = 0;
  return ((next++ == number && (variant = T{}, true)) || ...);
}

namespace detail {

/// Stands for a value of any type when members are counted.
struct AnyValue {
  template <class T>
  operator T() const;  // NOLINT: implicit on purpose
};

template <std::size_t>
using AnyValueAt = AnyValue;

template <class T, class Sequence, class = void>
struct TakesMembers : std::false_type {};
template <class T, std::size_t... I>
struct TakesMembers<T, std::index_sequence<I...>, std::void_t<decltype(T{AnyValueAt<I>{}...})>>
    : std::true_type {};

template <class T, std::size_t Count = 0>
constexpr std::size_t count_members() {
  if constexpr (!TakesMembers<T, std::make_index_sequence<Count + 1>>::value) {
    return Count;
  } else {
    return count_members<T, Count + 1>();
  }
}

template <class A, class B>
constexpr bool same_member(const A& a, const B& b) {
  if constexpr (std::is_same_v<A, B>) {
    return a.member == b.member;
  } else {
    return false;
  }
}

template <class First, class... Rest>
constexpr bool all_differ(const First& first, const Rest&... rest) {
  if ((same_member(first, rest) || ...)) return false;
  if constexpr (sizeof...(Rest) > 1) return all_differ(rest...);
  return true;
}

}  // namespace detail

/// Whether the list of a struct's fields has each of its members, once. To be asserted beside the
/// struct: a new member then does not compile until it is in the list.
template <class T>
constexpr bool lists_all_members() {
  constexpr auto kCount = std::tuple_size_v<decltype(T::fields())>;
  if (detail::count_members<T>() != kCount) return false;
  if constexpr (kCount == 0) {
    return true;
  } else {
    return std::apply([](const auto&... f) { return detail::all_differ(f...); }, T::fields());
  }
}

}  // namespace der
