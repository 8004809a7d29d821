#pragma once

#include <cstdint>
#include <string>

#include "der/assembly/assembler.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/solvers/predicted_tension.hpp"

namespace der {

class DiscreteGradientAssembler;

/// The nonlinear system that one stage of an implicit stepper, or a static analysis, has to solve
/// for the displacement d from the positions `origin`:
///   inertia M (d - inertia_target) + velocity_factor C (d - velocity_reference)
///     + grad E(origin + d, controls) - force = 0
/// over the free degrees of freedom; M is `mass`, C the model's diagonal damping. All vectors have
/// one entry a degree of freedom. The velocity that a stepper makes of a displacement has the
/// rounding error of the displacement; that of a difference of positions grows as steps get short.
struct Stage {
  explicit Stage(const Model& model);
  double inertia = 0.0;          ///< [1/s^2]; 0: statics
  Mass mass;                     ///< [kg]; the model's, unless a static analysis brings its own
  Vector origin;                 ///< [m]; zero unless set
  Vector inertia_target;         ///< [m] from the origin
  double velocity_factor = 0.0;  ///< [1/s]
  Vector velocity_reference;     ///< [m] from the origin
  Vector controls;               ///< values of the model's tables at the stage's time
  Vector force;                  ///< [N] external forces at the stage's time
  /// If set, it gives the forces in place of grad E: the stage is the middle of a step from
  /// `origin`.
  DiscreteGradientAssembler* discrete_gradient = nullptr;
};

struct NewtonOptions {
  double residual_tolerance = 1e-9;  ///< against the largest acting force
  double step_tolerance = 1e-9;      ///< against the model's size
  int max_iterations = 50;
};

struct NewtonReport {
  bool converged = false;
  int iterations = 0;
  double residual = 0.0;      ///< largest component over the free degrees of freedom [N]
  double force_scale = 0.0;   ///< largest acting force [N]
  Index worst_dof = -1;       ///< if not converged: full number of that with the largest residual
  Index negative_pivots = 0;  ///< of the last matrix, before any shift
  std::string failure;        ///< in words, if not converged
};

/// Newton's method for a Stage, on preallocated memory: an iteration allocates nothing.
///
/// First plain Newton steps, which converge fastest though the residual may rise on the way (a rod
/// that turns is first stretched by its step, then springs back), with the tensions of the matrix
/// from PredictedTension. If they do not get there, again from the guess with a line search on the
/// slope of the potential along the step. Where the matrix is not positive definite it is shifted
/// until it is, so that every step leads downhill.
class Newton {
 public:
  Newton(const Model& model, const Assembler& assembler, LinearSolver& solver,
         const NewtonOptions& options);

  /// Solves for `positions`: on entry the guess, with held degrees of freedom already at their
  /// values; on exit the solution, or the guess again if not converged.
  NewtonReport solve(const Stage& stage, Vector& positions);
  /// As above with the line search only: slower, but it does not jump to another valley.
  NewtonReport solve_downhill(const Stage& stage, Vector& positions);

  /// From the stage's origin to the last iterate [m], known to its own rounding.
  [[nodiscard]] const Vector& displacement() const { return displacement_; }
  /// Left side of the stage's equation at the last iterate, over all degrees of freedom [N]; on
  /// held ones it is the force that the support has to provide.
  [[nodiscard]] const Vector& residual() const { return residual_; }

 private:
  enum class Mode { FullSteps, LineSearch };

  NewtonReport iterate(const Stage& stage, Mode mode, Vector& positions);
  void evaluate_residual(const Stage& stage, const Vector& positions);
  void evaluate_system(const Stage& stage, const Vector& positions);
  void add_stage_forces(const Stage& stage);
  double noise(const Stage& stage, const Vector& positions);
  double find_direction(NewtonReport& report);
  double limit_turn(double& step);
  void move(const Stage& stage, const Vector& start, double factor, Vector& positions);
  double line_search(const Stage& stage, Vector& positions);
  [[nodiscard]] double slope() const;
  void measure(NewtonReport& report) const;
  [[nodiscard]] Index worst_dof() const;

  const Model& model_;
  const Assembler& assembler_;
  LinearSolver& solver_;
  NewtonOptions options_;
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> free_;  // the mask of the free degrees of freedom
  Vector per_squared_length_;                            // of each edge [1/m^2]
  Vector residual_;                                      // all degrees of freedom
  Vector term_;                                          // likewise: one term of it
  Vector values_;                                        // of the matrix, shifted where need be
  Vector direction_;                                     // over the free degrees of freedom
  Vector step_;            // the direction over all of them, zero on held ones
  Vector guess_;           // positions that the solve started from
  Vector displacement_;    // from the stage's origin
  Vector line_start_;      // displacement that the line search starts from
  double external_ = 0.0;  // largest external force of the stage [N]
  double acting_ = 0.0;    // largest acting force at the last iterate [N]
  double last_shift_ = 0.0;
  PredictedTension tension_;
};

}  // namespace der
