#pragma once

#include <array>
#include <string_view>

#include "der/core/index.hpp"
#include "der/core/types.hpp"

namespace der {

/// Coefficients of a diagonally implicit Runge-Kutta method: stage i of a step from t to t + dt,
///   k_i = f(t + c_i dt, y + dt sum_(j<i) a_ij k_j + dt a_ii k_i),   y' = y + dt sum b_i k_i.
/// All implicit stages have the same diagonal entry, so that they share the form of their matrix.
struct Tableau {
  static constexpr Index kMaxStages = 5;

  Index stages = 0;
  /// Whether the first stage is explicit: the slope at the start of the step.
  bool explicit_first = false;
  double diagonal = 0.0;  ///< a_ii of implicit stages
  std::array<std::array<double, to_size(kMaxStages - 1)>, to_size(kMaxStages)>
      below{};                                        ///< a_ij, j < i
  std::array<double, to_size(kMaxStages)> weights{};  ///< b_i

  [[nodiscard]] bool is_implicit(Index stage) const { return stage > 0 || !explicit_first; }
  /// c_i: when the stage is, from the start of the step, over its length.
  [[nodiscard]] double time(Index stage) const;
  /// Whether the last stage is the result.
  [[nodiscard]] bool stiffly_accurate() const;
  /// Whether it damps all that is fast for the step, as each is A-stable: what the step makes of a
  /// y' = c y vanishes as c grows.
  [[nodiscard]] bool is_l_stable() const;
};

/// Order 1, L-stable.
extern const Tableau kImplicitEuler;

/// Order 2, A-stable, symplectic; keeps linear and angular momentum and does not damp (Hairer,
/// Lubich and Wanner, Geometric Numerical Integration, section II.1).
extern const Tableau kImplicitMidpoint;

/// The trapezoidal rule over the part 2 - sqrt(2) of the step, then BDF2 over its end: order 2,
/// L-stable (Bank et al., IEEE Trans. CAD 4, 1985; as a Runge-Kutta method: Hosea and Shampine,
/// Appl. Numer. Math. 20, 1996).
extern const Tableau kTrBdf2;

/// Order 4, L-stable (Hairer and Wanner, Solving Ordinary Differential Equations II, table IV.6.5).
extern const Tableau kSdirk4;

/// Order 5, L-stable (SDIRK5()5L[1] of Kennedy and Carpenter, Diagonally Implicit Runge-Kutta
/// Methods for Ordinary Differential Equations, NASA/TM-2016-219173, section 5.3).
extern const Tableau kSdirk5;

/// The method that a scene names as its integrator; null where that is another kind of stepper.
const Tableau* find_tableau(std::string_view integrator);

}  // namespace der
