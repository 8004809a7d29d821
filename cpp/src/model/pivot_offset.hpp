#pragma once

#include "der/kinematics/pivot.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// From a node to the pivot [m] in a state, with the clamp as it is turned there; 0 without one.
inline Vec2 offset_of(const Pivot& pivot, const Model& model, const State& state) {
  if (pivot.rotation < 0) return pivot.reference_offset;
  return pivot.offset(control_value(model, state, pivot.rotation));
}

}  // namespace der
