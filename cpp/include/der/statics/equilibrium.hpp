#pragma once

#include <optional>

#include "der/assembly/assembler.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "der/statics/out_of_plane.hpp"
#include "der/statics/stiffness.hpp"

namespace der {

struct EquilibriumOptions {
  NewtonOptions newton;
  /// Leave a saddle for a stable equilibrium; otherwise a saddle is accepted as the result.
  bool leave_saddles = true;
  CancelCallback beat{};  ///< called at least once an iteration; what it throws ends the search
};

/// How a search for an equilibrium ended.
struct EquilibriumReport {
  std::optional<FailedSearch> failed;  ///< nothing if an equilibrium was found
  int newton_iterations = 0;
  int relaxations = 0;       ///< pseudo-time steps and those of dynamic relaxation; 0: Newton alone
  int saddles_left = 0;      ///< unstable equilibria that were found on the way and left downhill
  double residual = 0.0;     ///< largest unbalanced force [N] of the equilibrium found
  double force_scale = 0.0;  ///< largest acting force [N]
  Stability stability;       ///< of the equilibrium found
  /// Largest turning angle at a node [rad]; far above 1 the mesh is too coarse.
  double largest_turning_angle = 0.0;
  /// Whether an equilibrium of a planar model would leave its plane. `find_equilibrium`
  /// leaves it empty (Simulation::equilibrium).
  std::optional<OutOfPlane> out_of_plane;
};

/// Moves the positions of `state`, with the turns, to a static equilibrium under the loads at its
/// time; clamps in space begin where its ramps do. Leaves it as it is if the search fails or ends.
///
/// Newton's method comes first. Where it fails, pseudo-transient continuation follows the gradient
/// flow of the potential. Where that fails, too, the search goes on with load steps, then dynamic
/// relaxation, then restarts from bent and from straight shapes. An equilibrium with unstable
/// directions is left along the softest of them, to both sides, by the gradient flow; the lower of
/// the equilibria to which the two sides lead is taken, until one is stable.
///
/// Circulatory loads (energies/circulatory_load.hpp) have no potential: all loads are then raised
/// from none, and the equilibrium on that path has no verdict on its stability.
EquilibriumReport find_equilibrium(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const EquilibriumOptions& options,
                                   State& state);

}  // namespace der
