#include "der/model/prescribed_motion.hpp"
#include "der/steppers/explicit_force.hpp"
#include "der/steppers/implicit_stage.hpp"
#include "steppers/predictor.hpp"
#include "steppers/steppers.hpp"

namespace der {
namespace {

/// The weights of the start of the step in the equation of motion: am of its accelerations, af of
/// its positions and velocities. They single out one method of the family.
struct AlphaWeights {
  double accelerations = 0.0;
  double positions = 0.0;
};

/// Newmark's average acceleration (J. Eng. Mech. Div. ASCE 85, 1959; Hughes, The Finite Element
/// Method, ch. 9), beta = 1/4 and gamma = 1/2: the equation of motion holds at the end of the step.
/// No motion is damped.
constexpr AlphaWeights kNewmark{0.0, 0.0};

/// Chung and Hulbert's generalized-alpha method (J. Appl. Mech. 60, 1993): motion far above the
/// step's frequency shrinks by the spectral radius r in each step, slow motion is hardly damped.
AlphaWeights chung_hulbert(double r) { return {(2.0 * r - 1.0) / (1.0 + r), r / (1.0 + r)}; }

/// The family of methods
///   M ((1 - am) a' + am a) = F(y), y = (1 - af) q' + af q, likewise the velocity and the time,
///   q' = q + dt v + dt^2 ((1/2 - beta) a + beta a'), v' = v + dt ((1 - gamma) a + gamma a'),
/// with Chung and Hulbert's gamma and beta, which make it of second order and A-stable. The unknown
/// is y.
class AlphaMethod final : public Stepper {
 public:
  AlphaMethod(const AlphaWeights& weights, const Model& model, const Assembler& assembler,
              LinearSolver& solver, const NewtonOptions& options)
      : alpha_m_(weights.accelerations),
        alpha_f_(weights.positions),
        gamma_(0.5 - alpha_m_ + alpha_f_),
        beta_(0.25 * (1.0 - alpha_m_ + alpha_f_) * (1.0 - alpha_m_ + alpha_f_)),
        guess_(model),
        stage_(model, assembler, solver, options),
        force_(model, assembler),
        model_(model),
        start_velocities_(model.num_dofs()),
        start_accelerations_(model.num_dofs()),
        positions_(model.num_dofs()),
        velocities_(model.num_dofs()),
        accelerations_(model.num_dofs()) {}

  StepReport step(State& state, double dt) override {
    stage_.controls().begin_step(state, dt);
    stage_.controls().enter_stage(0);
    Vector& here = stage_.here.coordinates;
    stage_.apply_prescribed_motion_at(state, state.time + dt, here);
    start(state, here, dt);
    const Vector& q = state.positions;
    const Vector& v = start_velocities_;
    const Vector& a = start_accelerations_;
    const double kept = 1.0 - alpha_f_;
    Stage& equation = stage_.equation;

    // Inertia: M ((1 - am) a' + am a) is zero at the target.
    equation.inertia = (1.0 - alpha_m_) / (beta_ * dt * dt * kept);
    equation.inertia_target =
        kept * dt * (v + dt * (0.5 - beta_ - alpha_m_ * beta_ / (1.0 - alpha_m_)) * a);
    // Velocity: (1 - af) v' + af v is zero at the reference, where a' is such that v' is.
    equation.velocity_factor = gamma_ / (beta_ * dt);
    equation.velocity_reference = kept * dt * (v + dt * (0.5 - beta_) * a) -
                                  (beta_ / gamma_) * dt * (v + kept * dt * (1.0 - gamma_) * a);

    guess_.evaluate(state, dt, positions_);
    for (const HeldDof& held : model_.held) positions_[held.dof] = here[held.dof];
    here = kept * positions_ + alpha_f_ * q;
    hold_velocities(state, dt);
    const StepReport report = stage_.solve(state, state.time + kept * dt);
    if (report.outcome != StepOutcome::Done) return report;

    positions_ = q + stage_.displacement() / kept;
    stage_.apply_prescribed_motion_at(state, state.time + dt, positions_);
    accelerations_ =
        (stage_.displacement() / kept - dt * v) / (beta_ * dt * dt) - ((0.5 - beta_) / beta_) * a;
    velocities_ = v + dt * ((1.0 - gamma_) * a + gamma_ * accelerations_);
    state.accelerations = accelerations_;
    stage_.accumulate_and_finish(positions_, velocities_, dt, kept, force_, state);
    return report;
  }

 private:
  /// Sets velocities and accelerations at the start of a step at whose end held degrees of freedom
  /// are at `end`.
  void start(State& state, const Vector& end, double dt) {
    velocities_in_step(model_, state, end, dt, state.time, start_velocities_);
    if (state.last_step == 0.0) {
      force_.acceleration(state, state.positions, start_velocities_, state.time, 0.0,
                          state.accelerations);
      start_accelerations_ = state.accelerations;
      return;
    }
    start_accelerations_ = state.accelerations;
    if (!model_.has_sections()) return;
    velocities_ = start_velocities_ - state.velocities;
    if (velocities_.isZero(0.0)) return;
    force_.add_gyroscopic_change(state, velocities_, start_accelerations_);
  }

  /// So that the velocities of the stage are those of the motion.
  void hold_velocities(const State& state, double dt) {
    for (const HeldDof& held : model_.held) {
      const Index i = held.dof;
      const double moved = stage_.here.coordinates[i] - state.positions[i];
      const double mean = (positions_[i] - state.positions[i]) / dt;
      const double end = held_velocity(model_, state, held, state.time + dt, mean);
      const double velocity = (1.0 - alpha_f_) * end + alpha_f_ * start_velocities_[i];
      stage_.equation.velocity_reference[i] = moved - velocity / stage_.equation.velocity_factor;
    }
  }

  double alpha_m_;
  double alpha_f_;
  double gamma_;
  double beta_;
  Predictor guess_;
  ImplicitStage stage_;
  ExplicitForce force_;
  const Model& model_;
  Vector start_velocities_;  // of held degrees of freedom as in this step
  Vector start_accelerations_;
  Vector positions_;
  Vector velocities_;
  Vector accelerations_;
};

}  // namespace

std::unique_ptr<Stepper> make_generalized_alpha(const Model& model, const Assembler& assembler,
                                                LinearSolver& solver,
                                                const StepperOptions& options) {
  return std::make_unique<AlphaMethod>(chung_hulbert(options.spectral_radius), model, assembler,
                                       solver, options.newton);
}

std::unique_ptr<Stepper> make_newmark(const Model& model, const Assembler& assembler,
                                      LinearSolver& solver, const StepperOptions& options) {
  return std::make_unique<AlphaMethod>(kNewmark, model, assembler, solver, options.newton);
}

}  // namespace der
