#include "der/steppers/explicit_force.hpp"

#include "der/loads/loads.hpp"
#include "der/supports/supports.hpp"

namespace der {
namespace {

/// No material of a rod survives this; an unstable explicit step gets here within a few hundred
/// steps, long before numbers overflow.
constexpr double kLargestStretch = 100.0;

}  // namespace

ExplicitForce::ExplicitForce(const Model& model, const Assembler& assembler)
    : model_(model),
      assembler_(assembler),
      controls_(Vector::Zero(model.controls.size())),
      force_(Vector::Zero(model.num_dofs())),
      gradient_(Vector::Zero(model.num_dofs())) {}

void ExplicitForce::undamped_acceleration(const State& state, const Vector& positions, double time,
                                          Vector& acceleration) {
  model_.controls.evaluate(time, controls_);
  external_force(model_, controls_, state.extra_force, force_);
  assembler_.gradient(positions, controls_, gradient_);
  acceleration = (force_ - gradient_).cwiseQuotient(model_.mass);
  for (const HeldDof& held : model_.held) acceleration[held.dof] = 0.0;
}

void ExplicitForce::acceleration(const State& state, const Vector& positions,
                                 const Vector& velocities, double time, Vector& acceleration) {
  undamped_acceleration(state, positions, time, acceleration);
  for (const Index dof : model_.free_dofs) {
    acceleration[dof] -= model_.damping[dof] / model_.mass[dof] * velocities[dof];
  }
}

void ExplicitForce::place_held_at(double time, Vector& positions) {
  model_.controls.evaluate(time, controls_);
  place_held(model_, controls_, positions);
}

StepReport ExplicitForce::check(const Vector& positions) const {
  const auto& edges = std::get<ElementList<Stretch<2>>>(model_.elements);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto& dofs = edges.dofs[e];
    const double limit = kLargestStretch * edges.constants[e].rest_length;
    const double dx = positions[dofs[2]] - positions[dofs[0]];
    const double dy = positions[dofs[3]] - positions[dofs[1]];
    if (!(dx * dx + dy * dy < limit * limit)) {  // also true for NaN
      return {StepOutcome::Diverged, 0, dofs[2], "an edge grew beyond 100 times its length"};
    }
  }
  return {};
}

}  // namespace der
