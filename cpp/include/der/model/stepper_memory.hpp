#pragma once

#include <tuple>
#include <variant>

#include "der/core/types.hpp"
#include "der/model/fields.hpp"

namespace der {

/// A one-step method remembers nothing but the accelerations of a state.
struct NoMemory {
  static constexpr const char* kName = "none";
  static constexpr auto fields() { return std::tuple<>(); }
};

/// The step before, of the two-step backward differentiation formula.
struct Bdf2Memory {
  Vector displacement;  ///< [m] in that step
  Vector velocities;    ///< [m/s] at its start

  static constexpr const char* kName = "bdf2";
  static constexpr auto fields() {
    return std::make_tuple(
        field("displacement", "m", &Bdf2Memory::displacement, Values::Finite, Extent::Dofs),
        field("velocities", "m/s", &Bdf2Memory::velocities, Values::Finite, Extent::Dofs));
  }
};

/// Memory of explicit steppers: the shape for which the stable step was last evaluated.
struct StabilityMemory {
  Vector positions;  ///< [m]

  static constexpr const char* kName = "stability";
  static constexpr auto fields() {
    return std::make_tuple(
        field("positions", "m", &StabilityMemory::positions, Values::Finite, Extent::Dofs));
  }
};

static_assert(lists_all_members<NoMemory>() && lists_all_members<Bdf2Memory>() &&
              lists_all_members<StabilityMemory>());

/// Data that a stepper keeps of the previous steps, besides what every state has. Files hold the
/// number of an alternative here: append new ones.
using StepperMemory = std::variant<NoMemory, Bdf2Memory, StabilityMemory>;

/// The memory of that type: the one that is held, or else a new one in its place.
template <class Memory>
Memory& hold(StepperMemory& memory) {
  if (auto* held = std::get_if<Memory>(&memory)) return *held;
  return memory.emplace<Memory>();
}

}  // namespace der
