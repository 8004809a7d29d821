#pragma once

#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/core/error.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/statics/initial_stress.hpp"
#include "der/statics/stiffness.hpp"

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
/// freedom has no mass, NotConvergedError if modes cannot be found, or are
/// lost in rounding errors. `beat` is called at each factorisation and solution, as in all that
/// follows here.
std::vector<Mode> vibration_modes(const Model& model, const Assembler& assembler,
                                  LinearSolver& solver, const Configuration& here, int count,
                                  const CancelCallback& beat = {});

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
  /// That response: the displacement of all degrees of freedom for a unit of the load factor.
  Vector response;
  /// Whether the loads would make it buckle with reversed signs; checked only if there are no
  /// modes.
  bool reversed = false;
};

/// The `count` lowest positive factors a at which (K0 + a K1) v = 0 has a solution, fewer if there
/// are not so many: by bisection on the inertia of the sparse factorisation. `stiffness` is the
/// positive definite K0 at the shape `here`, on the same solver, and `stress` has K1.
std::vector<BucklingMode> buckling_modes(const Model& model, const Stiffness& stiffness,
                                         LinearSolver& solver, const Configuration& here,
                                         const InitialStress& stress, int count,
                                         const CancelCallback& beat = {});

/// Linear buckling: K0 is the stiffness of the unloaded equilibrium `state`, K1 that of the initial
/// stresses that all loads cause to first order (InitialStress). No modes if the loads do not make
/// it buckle. Throws NotConvergedError if the unloaded structure is not stable. The model has a
/// load variation, of all loads.
LinearBuckling linear_buckling(const Model& model, const Assembler& assembler, LinearSolver& solver,
                               const State& state, int count, const CancelCallback& beat = {});

}  // namespace der
