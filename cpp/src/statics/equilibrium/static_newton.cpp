#include "statics/equilibrium/static_newton.hpp"

#include <utility>

#include "der/statics/potential.hpp"

namespace der::statics {
namespace {

/// Differences of the potential below this fraction of the largest force times the model's size are
/// round-off.
constexpr double kEnergyResolution = 1e-13;
/// The step from the end of a continuation to the equilibrium changes no edge by more than this.
constexpr double kLargestLastChange = 0.5;

}  // namespace

StaticNewton::StaticNewton(const Model& model, const Assembler& assembler, LinearSolver& solver,
                           const NewtonOptions& options, Admissibility admissibility,
                           CancelCallback beat)
    : model_(model),
      problem_(model, assembler, {model.dofs.unit_masses(), {}}),
      newton_(model.dofs, solver, assembler.num_values(), options, std::move(beat)),
      admissibility_(std::move(admissibility)) {}

Stage StaticNewton::stage_of(const StaticLoads& loads) const {
  Stage stage(model_);
  stage.force = loads.force;
  stage.is_conservative = is_unloaded(model_, loads);
  return stage;
}

std::optional<FailedSearch> StaticNewton::solve(const Stage& stage, Configuration& here,
                                                LineSearch line_search) {
  const Vector before = here.coordinates;
  problem_.pose(stage, here);
  const NewtonReport report = line_search == LineSearch::Never    ? newton_.solve_nearby(problem_)
                              : line_search == LineSearch::Always ? newton_.solve_downhill(problem_)
                                                                  : newton_.solve(problem_);
  iterations_ += report.iterations;
  force_scale_ = report.force_scale;
  if (!report.converged) return FailedSearch{EquilibriumFailure::NewtonFailed, report.failure};
  auto inadmissible = admissibility_.check(here);
  if (inadmissible) here.coordinates = before;
  return inadmissible;
}

std::optional<FailedSearch> StaticNewton::balance(const StaticLoads& loads, Shape& shape,
                                                  LineSearch line_search) {
  Configuration here = loads.at(model_, shape);
  if (auto failed = solve(stage_of(loads), here, line_search)) return failed;
  shape.positions = std::move(here.coordinates);
  loads.follow(model_, shape);
  return std::nullopt;
}

StaticNewton::LastStep StaticNewton::balance_nearby(const StaticLoads& loads, Shape& shape) {
  Shape last = shape;
  if (auto failed = balance(loads, last)) return {false, 0.0, std::move(failed)};
  if (largest_edge_change(model_, last.positions - shape.positions) > kLargestLastChange) return {};
  const double change = energy_change(model_, loads, last, shape.positions, last.positions);
  if (!(change <= energy_resolution())) return {};
  shape = std::move(last);
  return {true, change, {}};
}

double StaticNewton::energy_resolution() const {
  return kEnergyResolution * force_scale_ * model_.size();
}

}  // namespace der::statics
