#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "der/assembly/assembler.hpp"
#include "der/catalog/steppers.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"

namespace der {

enum class StepOutcome {
  Done,
  NotConverged,
  Diverged,
  TooInaccurate,  ///< of adaptive steps: solved, but with too large an error in time
};

/// The result of one attempted step. If not done, the state is unchanged and `failure` says why.
struct StepReport {
  StepOutcome outcome = StepOutcome::Done;
  int newton_iterations = 0;
  Index worst_dof = -1;  ///< full number of the degree of freedom at which it failed; -1: none
  std::string failure;
};

/// Not done where an edge whose whole turns count has turned so far from where it is in `state`,
/// the start of the step, that the shorter way from there to `positions` may not be the one it
/// went.
StepReport check_turns(const Model& model, const State& state, const Vector& coordinates,
                       const Vector& controls);

/// Advances a state by one time step. One file for each time integrator.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// Tries one step of `dt` seconds from `state.time`; sets positions, velocities and memory, and
  /// leaves time and count to the caller.
  virtual StepReport step(State& state, double dt) = 0;
};

/// Settings of a stepper.
struct StepperOptions {
  NewtonOptions newton;
  /// For generalized_alpha: spectral radius at infinite frequency (0: full damping, 1: none;
  /// Chung and Hulbert, J. Appl. Mech. 60, 1993).
  double spectral_radius = 0.9;
};

/// The stepper of that name in the catalog. Throws Error if there is none.
std::unique_ptr<Stepper> make_stepper(std::string_view name, const Model& model,
                                      const Assembler& assembler, LinearSolver& solver,
                                      const StepperOptions& options);

}  // namespace der
