#include "der/model/prescribed_motion.hpp"
#include "der/steppers/explicit_force.hpp"
#include "der/steppers/step_commit.hpp"
#include "steppers/steppers.hpp"

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
        finisher_(model),
        positions_(model.num_dofs()),
        acceleration_(model.num_dofs()),
        mean_velocities_(model.num_dofs()),
        displacement_(model.num_dofs()),
        velocities_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    const double half = 0.5 * dt;
    positions_ = state.positions + half * state.velocities;
    velocities_ = state.velocities;
    if (model_.has_sections()) {  // gyroscopic forces see how held nodes move
      force_.apply_prescribed_motion_at(state, state.time + dt, positions_);
      velocities_in_step(model_, state, positions_, dt, state.time + half, velocities_);
    }
    force_.apply_prescribed_motion_at(state, state.time + half, positions_);
    force_.advance_rotations(state, half, state.velocities, positions_);
    if (!force_.acceleration(state, positions_, velocities_, state.time + half, half,
                             acceleration_)) {
      return {StepOutcome::Diverged, 0, model_.dofs.most_moved(acceleration_),
              "the sections spin too fast for the mass of the nodes"};
    }
    positions_ = state.positions + dt * (state.velocities + half * acceleration_);
    force_.apply_prescribed_motion_at(state, state.time + dt, positions_);
    const StepReport report = force_.check(state, positions_);
    if (report.outcome != StepOutcome::Done) return report;

    displacement_ = positions_ - state.positions;
    mean_velocities_ = displacement_ / dt;
    force_.accumulate(mean_velocities_, displacement_, state.work);
    velocities_ = state.velocities + dt * acceleration_;
    finisher_.finish(positions_, velocities_, dt, state);
    return report;
  }

 private:
  const Model& model_;
  ExplicitForce force_;
  StepCommit finisher_;
  Vector positions_;
  Vector acceleration_;
  Vector mean_velocities_;
  Vector displacement_;
  Vector velocities_;
};

}  // namespace

std::unique_ptr<Stepper> make_verlet(const Model& model, const Assembler& assembler,
                                     LinearSolver& /*solver*/, const StepperOptions& /*options*/) {
  return std::make_unique<Verlet>(model, assembler);
}

}  // namespace der
