#include "der/steppers/explicit_force.hpp"

#include <algorithm>

#include "der/core/sum_of.hpp"
#include "der/loads/external_force.hpp"
#include "der/model/dimension.hpp"
#include "der/model/internal_damping.hpp"
#include "der/model/prescribed_motion.hpp"
#include "der/model/spin.hpp"
#include "der/steppers/work.hpp"

namespace der {
namespace {

/// No material of a rod survives this; an unstable explicit step gets here within a few hundred
/// steps, long before numbers overflow.
constexpr double kLargestStretch = 100.0;
/// Change of the gyroscopic forces, over the largest force on a node, that ends their rounds.
constexpr double kCoupleTolerance = 1e-12;
/// Rounds that converge do so sooner: each one's change is that of the round before times about
/// the spin in half a step times the square of thickness over edge length.
constexpr int kMostRounds = 30;
/// Length [s] over which the rate of a table is taken at the first step, whose own is not known.
constexpr double kShort = 1e-6;

bool any_support_moves(const Model& model) {
  return std::any_of(model.held.begin(), model.held.end(),
                     [](const HeldDof& held) { return held.displacement >= 0; });
}

}  // namespace

ExplicitForce::ExplicitForce(const Model& model, const Assembler& assembler)
    : model_(model),
      assembler_(assembler),
      supports_move_(any_support_moves(model)),
      mass_(model),
      rotations_(model),
      here_{Vector::Zero(model.num_dofs()), Vector::Zero(model.tables.size())},
      scratch_controls_(here_.controls),
      force_(Vector::Zero(model.num_dofs())),
      gradient_(Vector::Zero(model.num_dofs())),
      viscous_(Vector::Zero(model.viscous ? model.num_dofs() : 0)),
      couple_(Vector::Zero(model.num_dofs())),
      next_couple_(couple_) {}

bool ExplicitForce::acceleration(const State& state, const Vector& positions,
                                 const Vector& velocities, double time, double damping_time,
                                 Vector& acceleration) {
  evaluate_loads(state, positions, time);
  evaluate_gradient();
  const auto solve = [&] {
    acceleration = force_ - gradient_ - model_.damping.cwiseProduct(velocities);
    if (model_.viscous) acceleration -= viscous_;
    if (model_.has_sections()) acceleration += couple_;
    mass_.solve(damping_time, acceleration);
  };
  const auto solve_damped = [&] {
    set_viscous_force(state, velocities, time);
    solve();
    if (!model_.viscous || damping_time == 0.0) return;
    mean_velocities_ = velocities + damping_time * acceleration;
    set_viscous_force(state, mean_velocities_, time);
    solve();
  };
  if (!model_.has_sections()) {
    solve_damped();
    return true;
  }
  const auto at_start = [&](Index dof) { return velocities[dof]; };
  const auto mean = [&](Index dof) { return velocities[dof] + damping_time * acceleration[dof]; };
  set_couple(at_start, couple_);
  solve_damped();
  bool converged = damping_time == 0.0;
  const double largest = model_.dofs.largest_force(gradient_);
  for (int round = 0; round < kMostRounds && !converged; ++round) {
    set_couple(mean, next_couple_);
    couple_.swap(next_couple_);
    next_couple_ -= couple_;
    // `check` reports a result that is not a number.
    converged = !(model_.dofs.largest_force(next_couple_) > kCoupleTolerance * largest);
    if (!converged) solve();
  }
  gradient_ -= couple_;
  return converged;
}

void ExplicitForce::evaluate_works(const State& state, const Vector& positions,
                                   const Vector& velocities, double time) {
  evaluate_loads(state, positions, time);
  set_viscous_force(state, velocities, time);
  // Only the reactions on held degrees of freedom need it, and those work where supports move.
  if (!supports_move_) return;
  evaluate_gradient();
  if (!model_.has_sections()) return;
  set_couple([&](Index dof) { return velocities[dof]; }, couple_);
  gradient_ -= couple_;
}

void ExplicitForce::add_gyroscopic_change(const State& state, const Vector& change,
                                          Vector& acceleration) {
  here_.coordinates = state.positions;
  evaluate_controls(model_, state, state.time, here_.controls);
  const Index first_angle = model_.dofs.num_positions();
  set_couple([&](Index dof) { return dof < first_angle ? change[dof] : state.velocities[dof]; },
             couple_);
  mass_.solve(0.0, couple_);
  acceleration += couple_;
}

void ExplicitForce::set_viscous_force(const State& state, const Vector& velocities, double time) {
  if (!model_.viscous) return;
  const double until = state.time + (state.last_step > 0.0 ? state.last_step : kShort);
  set_turn_rates(model_, state, state.time, std::max(time, until), time, turn_rates_);
  viscous_.setZero();
  rates_ = velocities;
  rotations_.set_rates(here_, state.extra_force, rates_);
  add_viscous_forces(model_, {here_, rates_, turn_rates_}, viscous_);
}

void ExplicitForce::advance_rotations(const State& state, double dt, const Vector& velocities,
                                      Vector& positions) {
  if (!rotations_.any_lags()) return;
  rates_ = velocities;
  rotations_.advance({state, state.positions, state.velocities, dt}, positions, rates_);
}

void ExplicitForce::set_rotation_rates(const State& state, Vector& velocities) {
  if (!rotations_.any_lags()) return;
  here_.coordinates = state.positions;
  evaluate_controls(model_, state, state.time, here_.controls);
  rotations_.set_rates(here_, state.extra_force, velocities);
}

void ExplicitForce::evaluate_gradient() {
  assembler_.gradient(here_, gradient_);
  const auto force = [&](const SpatialEdge& edge, Index number, const Vec3& vector) {
    return transport_force(vector, number, gradient_[edge.theta], here_.controls);
  };
  take_pairs(model_, here_, force, gradient_);
}

/// At the rates `velocity(dof)`.
template <class Velocity>
void ExplicitForce::set_couple(const Velocity& velocity, Vector& couple) const {
  const auto force = [&](const SpatialEdge& edge, Index /*number*/, const Vec3& vector) {
    return Vec3(-gyroscopic_force(edge, vector, model_.mass, velocity));
  };
  couple.setZero();
  take_pairs(model_, here_, force, couple);
}

void ExplicitForce::evaluate_loads(const State& state, const Vector& positions, double time) {
  here_.coordinates = positions;
  here_.load_factor = state.load_factor;
  evaluate_controls(model_, state, time, here_.controls);
  rotations_.settle(here_.controls, state.extra_force, here_.coordinates,
                    JointRotations::Which::Undamped);
  external_force(model_, here_, state.extra_force, force_);
}

void ExplicitForce::accumulate(const Vector& velocities, const Vector& displacement,
                               Work& work) const {
  const auto size = static_cast<Index>(displacement.size());
  work.loads +=
      sum_of<double>(
          size, [&](Index i) { return displacement[i] * (force_[i] - model_.gravity_force[i]); }) +
      moment_work(model_, here_, displacement);
  work.drag += sum_of<double>(
      size, [&](Index i) { return displacement[i] * (model_.damping[i] * velocities[i]); });
  if (model_.viscous) work.drag += displacement.dot(viscous_);
  for (const HeldDof& held : model_.held) {
    // The step's finisher has the drag on held nodes.
    work.drag -= displacement[held.dof] * model_.damping[held.dof] * velocities[held.dof];
    work.supports += displacement[held.dof] * (gradient_[held.dof] - force_[held.dof]);
    if (model_.viscous) work.supports += displacement[held.dof] * viscous_[held.dof];
  }
}

void ExplicitForce::apply_prescribed_motion_at(const State& state, double time, Vector& positions) {
  evaluate_controls(model_, state, time, scratch_controls_);
  apply_prescribed_motion(model_, scratch_controls_, positions);
}

StepReport ExplicitForce::check(const State& state, const Vector& positions) const {
  for (const Edge& edge : model_.edges) {
    const double limit = kLargestStretch * edge.rest_length;
    const double squared = with_dimension(
        model_, [&](auto dim) { return along_edge<dim>(edge, positions).squaredNorm(); });
    if (!(squared < limit * limit)) {  // also true for NaN
      return {StepOutcome::Diverged, 0, edge.last, "an edge grew beyond 100 times its length"};
    }
  }
  return check_turns(model_, state, positions, here_.controls);
}

}  // namespace der
