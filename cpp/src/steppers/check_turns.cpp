#include "der/core/index.hpp"
#include "der/steppers/stepper.hpp"

namespace der {

StepReport check_turns(const Model& model, const State& state, const Vector& positions) {
  const Index edge = edge_turned_too_far(model, positions, state.turns);
  if (edge < 0) return {};
  return {StepOutcome::NotConverged, 0, model.followed_edges[to_size(edge)].edge.last,
          "beside a spring or a clamp the rod turned by more than a quarter of a turn at once"};
}

}  // namespace der
