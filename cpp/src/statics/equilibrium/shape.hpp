#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/turns.hpp"

namespace der::statics {

/// A shape of the structure. Positions determine the turns of the followed edges only up to whole
/// turns, so a shape carries both.
struct Shape {
  Vector positions;  ///< all degrees of freedom [m]
  Vector turns;      ///< of the followed edges [rad], as in the state
};

/// Updates the turns of a shape whose positions have changed a little.
inline void update_turns(const Model& model, Shape& shape) {
  follow_turns(model, shape.positions, shape.turns);
}

}  // namespace der::statics
