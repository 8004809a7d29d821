#include "der/steppers/stepper.hpp"

namespace der {

StepReport check_turns(const Model& model, const State& state, const Vector& coordinates,
                       const Vector& controls) {
  const Index dof = turned_too_far(model, coordinates, controls, state.followed);
  if (dof < 0) return {};
  return {StepOutcome::NotConverged, 0, dof,
          "an edge of the rod turned by more than a quarter of a turn at once"};
}

}  // namespace der
