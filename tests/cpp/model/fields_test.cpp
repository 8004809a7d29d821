// The lists of fields by which states are saved: whole, in order, and what is read by them is what
// was written.
#include "der/model/fields.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "der/model/state.hpp"
#include "model/same_state.hpp"

namespace der::test {
namespace {

struct Whole {
  double a = 0.0;
  double b = 0.0;
  static constexpr auto fields() {
    return std::make_tuple(field("a", "", &Whole::a), field("b", "", &Whole::b));
  }
};
struct Short {
  double a = 0.0;
  Vector b;
  static constexpr auto fields() { return std::make_tuple(field("a", "", &Short::a)); }
};
struct Twice {
  double a = 0.0;
  double b = 0.0;
  static constexpr auto fields() {
    return std::make_tuple(field("a", "", &Twice::a), field("b", "", &Twice::a));
  }
};
/// With a member of every kind that a field can be; the one at the end is forgotten.
struct Nested {
  Whole whole;
  std::vector<Whole> list;
  std::variant<Whole, Twice> either;
  Vector vector;
  std::int64_t forgotten = 0;
  static constexpr auto fields() {
    return std::make_tuple(field("whole", "", &Nested::whole), field("list", "", &Nested::list),
                           field("either", "", &Nested::either),
                           field("vector", "", &Nested::vector));
  }
};

static_assert(lists_all_members<Whole>());
static_assert(!lists_all_members<Short>());
static_assert(!lists_all_members<Twice>());
static_assert(!lists_all_members<Nested>());

/// A value of its own in every number that a struct of fields has.
struct Counting {
  double next = 1.0;
  template <class Value>
  void fill(Value& value) {
    if constexpr (std::is_arithmetic_v<Value>) {
      value = static_cast<Value>(next++);
    } else if constexpr (std::is_same_v<Value, Vector>) {
      value.resize(3);
      for (double& entry : value) entry = 1.0 / next++;
    } else if constexpr (IsList<Value>::value) {
      value.resize(2);
      for (auto& item : value) fill(item);
    } else if constexpr (IsVariant<Value>::value) {
      std::visit([&](auto& held) { fill(held); }, value);
    } else {
      for_each_field(value, [&](const auto& /*field*/, auto& member) { fill(member); });
    }
  }
};

template <class Memory>
State counted() {
  State state;
  state.memory = Memory{};
  Counting{}.fill(state);
  return state;
}

}  // namespace

TEST_CASE("every number of a state is visited, and a change of any is seen") {
  // By hand: 6 numbers, 6 works, 6 of the audit and two ramps of 8.
  const State state = counted<Bdf2Memory>();
  std::size_t numbers = 0;
  std::size_t vectors = 0;
  for_each_value(state, [&](const auto& /*field*/, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Vector>) {
      ++vectors;
    } else {
      ++numbers;
    }
  });
  CHECK(vectors == 5 + 2);                      // of the state and of its memory
  CHECK(numbers == 6 + 6 + 6 + 2 * 8 + 1 + 1);  // with the length of the list, the kind of memory

  State other = state;
  CHECK(first_difference(state, other).empty());
  other.ramps[1].to += 1.0;
  CHECK(first_difference(state, other) == "to");
  other = state;
  std::get<Bdf2Memory>(other.memory).velocities[2] += 1.0;
  CHECK(first_difference(state, other) == "velocities");
  other = state;
  other.memory = NoMemory{};
  CHECK(first_difference(state, other) == "memory");
}

TEST_CASE("an alternative is made by its number, and by no other") {
  StepperMemory memory;
  CHECK(emplace_alternative(memory, 2));
  CHECK(std::holds_alternative<StabilityMemory>(memory));
  for (const std::int64_t none : {std::int64_t{-1}, std::int64_t{3}, std::int64_t{1} << 40}) {
    CHECK_FALSE(emplace_alternative(memory, none));
    CHECK(std::holds_alternative<StabilityMemory>(memory));
  }
}

TEST_CASE("a copy of a state over one of its kind allocates nothing") {
  const State from = counted<StabilityMemory>();
  State to = counted<StabilityMemory>();
  const double* before = std::get<StabilityMemory>(to.memory).positions.data();
  to = from;
  CHECK(std::get<StabilityMemory>(to.memory).positions.data() == before);
  hold<StabilityMemory>(to.memory).positions = from.positions;
  CHECK(std::get<StabilityMemory>(to.memory).positions.data() == before);
}

TEST_CASE("numbers that no state has are named") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  State state = counted<Bdf2Memory>();
  CHECK(find_wrong_value(state).empty());
  state.positions[0] = nan;  // a program may have written it
  CHECK(find_wrong_value(state).empty());
  state.last_step = -1.0;
  CHECK(find_wrong_value(state) ==
        "the last step of the state is -1: it must be a finite number, 0 or greater");
  state.last_step = 0.0;
  std::get<Bdf2Memory>(state.memory).displacement[1] = nan;
  CHECK(find_wrong_value(state) ==
        "the displacement of the state is nan: it must be a finite number");
}

}  // namespace der::test
