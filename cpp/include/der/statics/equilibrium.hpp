#pragma once

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/newton.hpp"

namespace der {

/// How a search for an equilibrium ended.
struct EquilibriumReport {
  bool converged = false;
  int newton_iterations = 0;
  int relaxations = 0;        ///< pseudo-time steps taken on the way; 0: Newton found it directly
  double residual = 0.0;      ///< largest unbalanced force [N]
  double force_scale = 0.0;   ///< largest acting force [N]
  Index negative_pivots = 0;  ///< unstable directions of the equilibrium found; 0: stable
  std::string failure;
};

/// Moves `positions` to a static equilibrium under the loads at `state.time`.
///
/// Newton first. Where it fails, the positions follow the gradient flow x' = -grad(potential) by
/// implicit Euler in a pseudo-time whose step grows as the forces come into balance
/// (pseudo-transient continuation, Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998), so that the
/// shape goes downhill the way a rod in a viscous fluid would, and ends in Newton's method.
EquilibriumReport find_equilibrium(const Model& model, const Assembler& assembler,
                                   LinearSolver& solver, const NewtonOptions& options,
                                   const State& state, Vector& positions);

}  // namespace der
