#include "der/steppers/explicit_force.hpp"
#include "steppers.hpp"

namespace der {
namespace {

/// Position Verlet: half a drift, a kick by the forces in the middle, half a drift. Second order,
/// symplectic, keeps linear and angular momentum; one force evaluation a step. Linear damping is
/// taken by the implicit midpoint rule, which is linear, so drag does not limit the step; the
/// fastest elastic mode does.
class Verlet final : public Stepper {
 public:
  Verlet(const Model& model, const Assembler& assembler)
      : model_(model),
        force_(model, assembler),
        positions_(model.num_dofs()),
        acceleration_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    const double half = 0.5 * dt;
    positions_ = state.positions + half * state.velocities;
    force_.place_held_at(state.time + half, positions_);
    force_.acceleration(state, positions_, state.velocities, state.time + half, half,
                        acceleration_);
    StepReport report = force_.check(positions_);
    if (report.outcome != StepOutcome::Done) return report;

    for (const Index dof : model_.free_dofs) {
      state.velocities[dof] += dt * acceleration_[dof];
      state.positions[dof] = positions_[dof] + half * state.velocities[dof];
    }
    force_.place_held_at(state.time + dt, positions_);
    for (const HeldDof& held : model_.held) {
      state.velocities[held.dof] = (positions_[held.dof] - state.positions[held.dof]) / dt;
      state.positions[held.dof] = positions_[held.dof];
    }
    state.last_step = dt;
    return report;
  }

 private:
  const Model& model_;
  ExplicitForce force_;
  Vector positions_;
  Vector acceleration_;
};

}  // namespace

std::unique_ptr<Stepper> make_verlet(const Model& model, const Assembler& assembler,
                                     LinearSolver& /*solver*/, const StepperOptions& /*options*/) {
  return std::make_unique<Verlet>(model, assembler);
}

}  // namespace der
