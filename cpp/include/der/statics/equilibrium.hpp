#pragma once

#include <string>

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"
#include "der/statics/stiffness.hpp"

namespace der {

struct EquilibriumOptions {
  NewtonOptions newton;
  /// Leave an equilibrium that is a saddle for a stable one; otherwise it is the answer.
  bool leave_saddles = true;
};

/// How a search for an equilibrium ended.
struct EquilibriumReport {
  bool converged = false;
  int newton_iterations = 0;
  int relaxations = 0;       ///< pseudo-time steps taken on the way; 0: Newton found it directly
  int saddles_left = 0;      ///< unstable equilibria that were found on the way and left downhill
  double residual = 0.0;     ///< largest unbalanced force [N]
  double force_scale = 0.0;  ///< largest acting force [N]
  Stability stability;       ///< of the equilibrium found
  double largest_turning_angle =
      0.0;  ///< largest turning angle at a node [rad]; far above 1: a coarse mesh
  /// The failure's name, if not converged: "not_converged", "not_held" (a load moves the structure
  /// as a rigid body), "unbounded" (it moves on without end), "collapsed" (an edge is pressed to a
  /// point) or "folded" (an edge is folded back on the one before).
  std::string status;
  std::string failure;  ///< in words
};

/// Moves the positions of `state`, with the turns, to a static equilibrium under the loads at its
/// time; leaves the state as it is if there is none.
///
/// Newton first. Where it fails, the positions follow the gradient flow x' = -grad(potential) by
/// implicit Euler in a pseudo-time whose step grows as the forces come into balance
/// (pseudo-transient continuation, Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998), so that the
/// shape goes downhill the way a rod in a viscous fluid would; every step must lower the potential.
/// An equilibrium with unstable directions is left along the softest of them, to both sides, and
/// the flow followed from there; the state of lower potential is taken, until one is stable.
EquilibriumReport find_equilibrium(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const EquilibriumOptions& options,
                                   State& state);

}  // namespace der
