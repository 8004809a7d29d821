#pragma once

#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// One free vibration about an equilibrium: shape * cos(2 pi frequency t), or, where the
/// equilibrium is unstable, shape * exp(growth_rate t).
struct Mode {
  double frequency = 0.0;    ///< [Hz]; 0 for a rigid motion that nothing holds, and where it grows
  double growth_rate = 0.0;  ///< [1/s]; 0 where it vibrates
  Vector shape;              ///< all degrees of freedom, of modal mass shape' M shape = 1 kg
};

/// The `count` modes of lowest frequency (fewer if there are not so many degrees of freedom) about
/// an equilibrium: K v = w^2 M v with the tangent stiffness, so that
/// tensions, moments and curved shapes count. Lanczos' method on the sparse factorisation of K - s
/// M (Ericsson and Ruhe, Math. Comp. 35, 1980; the library Spectra), repeated until the inertia of
/// the factorisation says that none is missing. Damping is left out. Throws Error if a degree of
/// freedom has no mass, NotConvergedError if modes cannot be found.
std::vector<Mode> vibration_modes(const Model& model, const Assembler& assembler,
                                  LinearSolver& solver, const Configuration& here, int count);

/// A load at which the straight or little deformed structure becomes unstable.
struct BucklingMode {
  double load_factor = 0.0;  ///< times the scene's loads
  Vector shape;              ///< all degrees of freedom, the largest displacement 1
};

/// The result of linear buckling, with measures of whether the theory applies. It assumes that the
/// prebuckling shape is the unloaded one, so its factors are accurate only if the loads have hardly
/// deformed the structure when it buckles.
struct LinearBuckling {
  std::vector<BucklingMode> modes;
  /// Largest rotation [rad] and strain of an edge in the linear response to the scene's loads, that
  /// is for each unit of the load factor.
  double rotation = 0.0;
  double strain = 0.0;
  /// Whether the loads would make it buckle with reversed signs; checked only if there are no
  /// modes.
  bool reversed = false;
};

/// Linear buckling: the lowest positive factors a of all loads at which (K0 + a K1) v = 0 has a
/// solution. K0 is the stiffness of the unloaded equilibrium `state`; K1 is the stiffness
/// across the edges from the tensions that the loads cause to first order, the initial-stress
/// stiffness of the classical theory. Moments are left out of K1: they would couple the turning of
/// an edge with its stretching, which makes a straight beam buckle under a load across it of about
/// sqrt(EA EI), where terms of second order in the displacement, left out too, cancel that.
/// Found by bisection on the inertia of the sparse factorisation. No modes if the loads do not make
/// it buckle. Throws NotConvergedError if the unloaded structure is not stable. The model has a
/// load variation, of all loads.
LinearBuckling linear_buckling(const Model& model, const Assembler& assembler, LinearSolver& solver,
                               const State& state, int count);

}  // namespace der
