#include "der/steppers/explicit_force.hpp"
#include "der/steppers/step_commit.hpp"
#include "steppers/steppers.hpp"

namespace der {
namespace {

/// v' = v + dt M^-1 F(q, v, t), q' = q + dt v': all forces at the old state, the new position from
/// the new velocity. First order; stable only below a step that the stiffest spring
/// or the strongest drag sets.
class ExplicitEuler final : public Stepper {
 public:
  ExplicitEuler(const Model& model, const Assembler& assembler)
      : force_(model, assembler),
        finisher_(model),
        acceleration_(model.num_dofs()),
        positions_(model.num_dofs()),
        displacement_(model.num_dofs()),
        velocities_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    force_.acceleration(state, state.positions, state.velocities, state.time, 0.0, acceleration_);
    velocities_ = state.velocities + dt * acceleration_;
    positions_ = state.positions + dt * velocities_;
    force_.apply_prescribed_motion_at(state, state.time + dt, positions_);
    const StepReport report = force_.check(state, positions_);
    if (report.outcome != StepOutcome::Done) return report;

    displacement_ = positions_ - state.positions;
    force_.accumulate(state.velocities, displacement_, state.work);
    finisher_.finish(positions_, velocities_, dt, state);
    return report;
  }

 private:
  ExplicitForce force_;
  StepCommit finisher_;
  Vector acceleration_;
  Vector positions_;
  Vector displacement_;
  Vector velocities_;
};

}  // namespace

std::unique_ptr<Stepper> make_explicit_euler(const Model& model, const Assembler& assembler,
                                             LinearSolver& /*solver*/,
                                             const StepperOptions& /*options*/) {
  return std::make_unique<ExplicitEuler>(model, assembler);
}

}  // namespace der
