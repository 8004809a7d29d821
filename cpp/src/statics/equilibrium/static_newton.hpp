#pragma once

#include <optional>

#include "der/assembly/assembler.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/solvers/newton.hpp"
#include "der/solvers/stage.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "statics/equilibrium/admissibility.hpp"
#include "statics/equilibrium/shape.hpp"
#include "statics/equilibrium/static_loads.hpp"

namespace der::statics {

/// Newton's method for static equilibria and for the implicit steps that lead there. Accepts only
/// admissible shapes.
class StaticNewton {
 public:
  /// `beat` is called once an iteration.
  StaticNewton(const Model& model, const Assembler& assembler, LinearSolver& solver,
               const NewtonOptions& options, Admissibility admissibility, CancelCallback beat);

  /// Never: plain steps alone, to a solution near by, be it stable or not.
  enum class LineSearch { Never, IfNeeded, Always };

  /// Moves `shape` to the equilibrium to which Newton's method leads from it.
  /// On failure the shape stays as it is.
  std::optional<FailedSearch> balance(const StaticLoads& loads, Shape& shape,
                                      LineSearch line_search = LineSearch::IfNeeded);

  /// How `balance_nearby` ended.
  struct LastStep {
    bool reached = false;
    double energy_change = 0.0;          ///< [J], if reached
    std::optional<FailedSearch> failed;  ///< set if Newton's method failed
  };
  /// As `balance`, for the end of a continuation: the equilibrium must be near and must not have a
  /// higher potential. Otherwise the shape stays as it is.
  LastStep balance_nearby(const StaticLoads& loads, Shape& shape);

  /// Solves a stage for the coordinates of `here`. On failure they stay as they are.
  std::optional<FailedSearch> solve(const Stage& stage, Configuration& here,
                                    LineSearch line_search = LineSearch::IfNeeded);

  /// The equation of equilibrium with unit masses and, until it is set, no inertia.
  [[nodiscard]] Stage stage_of(const StaticLoads& loads) const;

  void measure_drift_from(const Vector& origin) { admissibility_.measure_drift_from(origin); }

  /// Newton iterations of all solves so far.
  [[nodiscard]] int iterations() const { return iterations_; }
  /// Largest acting force [N] in the last solve.
  [[nodiscard]] double force_scale() const { return force_scale_; }
  /// Differences of the potential below this [J] are round-off.
  [[nodiscard]] double energy_resolution() const;

 private:
  const Model& model_;
  StageProblem problem_;
  Newton newton_;
  Admissibility admissibility_;
  int iterations_ = 0;
  double force_scale_ = 0.0;
};

}  // namespace der::statics
