#include "der/solvers/newton.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "der/assembly/discrete_gradient_assembler.hpp"
#include "der/core/index.hpp"
#include "stage_kernels.hpp"

namespace der {
namespace {

/// Plain Newton steps that have not converged by then rarely do.
constexpr int kFullStepIterations = 12;
/// No step turns an edge by more than this [rad]: beyond it the quadratic model says nothing.
constexpr double kLargestTurn = 0.7;
/// A step below this share of the size may well be the last: look before building a new matrix.
constexpr double kNearSolution = 1e-3;

/// A few rounding errors of numbers up to this.
double rounding(double largest) { return 8.0 * std::numeric_limits<double>::epsilon() * largest; }

CountMask free_dofs_count(const Model& model) {
  CountMask counts = CountMask::Zero(model.num_dofs());
  for (const Index dof : model.free_dofs) counts[dof] = kCounts;
  return counts;
}

Vector inverse_squared_lengths(const Model& model) {
  Vector result(static_cast<Index>(model.edges.size()));
  for (Index i = 0; i < result.size(); ++i) {
    result[i] = 1.0 / (model.edges[at(i)].rest_length * model.edges[at(i)].rest_length);
  }
  return result;
}

}  // namespace

Stage::Stage(const Model& model)
    : mass(model.mass),
      origin(Vector::Zero(model.num_dofs())),
      inertia_target(Vector::Zero(model.num_dofs())),
      velocity_reference(Vector::Zero(model.num_dofs())),
      controls(Vector::Zero(model.controls.size())),
      force(Vector::Zero(model.num_dofs())) {}

Newton::Newton(const Model& model, const Assembler& assembler, LinearSolver& solver,
               const NewtonOptions& options)
    : model_(model),
      assembler_(assembler),
      solver_(solver),
      options_(options),
      free_(free_dofs_count(model)),
      per_squared_length_(inverse_squared_lengths(model)),
      residual_(Vector::Zero(model.num_dofs())),
      term_(Vector::Zero(model.num_dofs())),
      values_(Vector::Zero(assembler.num_values())),
      direction_(Vector::Zero(model.num_free())),
      step_(Vector::Zero(model.num_dofs())),
      guess_(Vector::Zero(model.num_dofs())),
      displacement_(Vector::Zero(model.num_dofs())),
      line_start_(Vector::Zero(model.num_dofs())),
      tension_(model, assembler) {}

NewtonReport Newton::solve(const Stage& stage, Vector& positions) {
  last_shift_ = 0.0;  // a step must not depend on those before but by the state
  guess_ = positions;
  NewtonReport report = iterate(stage, Mode::FullSteps, positions);
  if (report.converged) return report;

  const int spent = report.iterations;
  positions = guess_;
  report = solve_downhill(stage, positions);
  report.iterations += spent;
  return report;
}

NewtonReport Newton::solve_downhill(const Stage& stage, Vector& positions) {
  guess_ = positions;
  NewtonReport report = iterate(stage, Mode::LineSearch, positions);
  if (!report.converged) positions = guess_;
  return report;
}

NewtonReport Newton::iterate(const Stage& stage, Mode mode, Vector& positions) {
  const int limit = mode == Mode::FullSteps ? std::min(kFullStepIterations, options_.max_iterations)
                                            : options_.max_iterations;
  const bool predicts_tension = mode == Mode::FullSteps && stage.discrete_gradient == nullptr;
  NewtonReport report;
  external_ = largest_magnitude(stage.force);
  displacement_ = positions - stage.origin;
  evaluate_system(stage, positions);
  measure(report);
  while (report.iterations < limit) {
    const double residual_before = report.residual;
    double step = std::isfinite(residual_before) ? find_direction(report) : residual_before;
    if (!std::isfinite(step)) {
      report.worst_dof = worst_dof();
      report.failure = "the forces or the stiffness stopped being numbers";
      return report;
    }
    ++report.iterations;
    const double turn = limit_turn(step);
    bool have_system = false;
    if (mode == Mode::FullSteps) {
      move(stage, displacement_, 1.0, positions);
      have_system = step > kNearSolution * model_.size;
      if (have_system) {
        evaluate_system(stage, positions);
        if (predicts_tension) tension_.use(positions, direction_, values_);
      } else {
        evaluate_residual(stage, positions);
      }
    } else {
      step *= line_search(stage, positions);
    }
    measure(report);

    // The next step is about as much smaller than this one as the residual has become; but the
    // residual of stiff stretching hides that of soft bending, so also no less than what the
    // rotation of the edges, which a Newton step leaves out, makes of this step.
    const double fall = residual_before > 0.0 ? report.residual / residual_before : 0.0;
    const double next_step = step * std::min(1.0, std::max(fall, turn));
    // Far from the origin positions themselves are only known to their rounding.
    const bool is_short = next_step <= options_.step_tolerance * model_.size ||
                          next_step <= rounding(largest_magnitude(positions));
    if (is_short) {
      report.converged = report.residual <= options_.residual_tolerance * report.force_scale;
      if (!report.converged) {
        report.converged = report.residual <= noise(stage, positions);
        have_system = false;
      }
      if (report.converged) return report;
    }
    if (have_system) continue;
    evaluate_system(stage, positions);
    if (predicts_tension) tension_.use(positions, direction_, values_);
  }
  report.worst_dof = worst_dof();
  report.failure = "no convergence in " + std::to_string(options_.max_iterations) + " iterations";
  return report;
}

void Newton::evaluate_residual(const Stage& stage, const Vector& positions) {
  if (stage.discrete_gradient != nullptr) {
    stage.discrete_gradient->gradient(stage.origin, positions, residual_);
  } else {
    assembler_.gradient(positions, stage.controls, residual_);
  }
  add_stage_forces(stage);
}

void Newton::evaluate_system(const Stage& stage, const Vector& positions) {
  if (stage.discrete_gradient != nullptr) {
    stage.discrete_gradient->gradient_and_hessian(stage.origin, positions, stage.controls,
                                                  residual_, values_);
  } else {
    assembler_.gradient_and_hessian(positions, stage.controls, residual_, values_);
  }
  add_stage_forces(stage);
  if (stage.inertia != 0.0) assembler_.add_mass(stage.mass, stage.inertia, values_);
  if (stage.velocity_factor != 0.0 && model_.damped) {
    assembler_.add_diagonal(model_.damping, stage.velocity_factor, values_);
  }
}

/// Rounding error [N] of the forces: positions are known to theirs, displacements to their own.
/// Leaves the elements' matrix alone in `values_`.
double Newton::noise(const Stage& stage, const Vector& positions) {
  assembler_.gradient_and_hessian(positions, stage.controls, term_, values_);
  const auto largest_term = [&](const Vector& diagonal) {
    term_ = diagonal.cwiseProduct(displacement_);
    return largest_magnitude(term_);
  };
  return rounding(largest_magnitude(values_) * largest_magnitude(positions) +
                  stage.inertia * largest_term(stage.mass.lumped) +
                  stage.velocity_factor * largest_term(model_.damping));
}

void Newton::add_stage_forces(const Stage& stage) {
  acting_ = std::max(subtract_force(stage.force, residual_), external_);
  if (stage.inertia != 0.0) {
    Vector& acceleration = term_;  // minus it
    acting_ = std::max(acting_, add_lumped_inertia(stage.inertia, stage.mass.lumped, displacement_,
                                                   stage.inertia_target, acceleration, residual_));
    for (const auto& [a, b, mass] : stage.mass.coupling) {
      const double inertial = mass * (acceleration[a] - acceleration[b]);
      residual_[a] -= inertial;
      residual_[b] += inertial;
    }
  }
  if (stage.velocity_factor != 0.0 && model_.damped) {
    acting_ =
        std::max(acting_, add_lumped_inertia(stage.velocity_factor, model_.damping, displacement_,
                                             stage.velocity_reference, term_, residual_));
  }
}

/// Sets the step, and returns its largest component [m]; not a number if there is none.
double Newton::find_direction(NewtonReport& report) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Inertia inertia = solver_.factorize(values_);
  report.negative_pivots = inertia.negative_pivots;
  if (!inertia.factorised || inertia.negative_pivots > 0) {
    // Shift by ever more until positive definite, starting a little below the last shift needed.
    const double largest = values_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(largest)) return none;
    double shift = std::max(1e-12 * largest, 0.1 * last_shift_);
    double applied = 0.0;
    do {
      assembler_.shift_diagonal(shift - applied, values_);
      applied = shift;
      shift *= 4.0;
      inertia = solver_.factorize(values_);
    } while ((!inertia.factorised || inertia.negative_pivots > 0) && applied < 1e3 * largest);
    last_shift_ = applied;
    if (!inertia.factorised) return none;
  }
  for (std::size_t i = 0; i < model_.free_dofs.size(); ++i) {
    direction_[static_cast<Index>(i)] = -residual_[model_.free_dofs[i]];
  }
  solver_.solve(direction_);
  for (std::size_t i = 0; i < model_.free_dofs.size(); ++i) {
    step_[model_.free_dofs[i]] = direction_[static_cast<Index>(i)];
  }
  return largest_magnitude(step_);
}

void Newton::move(const Stage& stage, const Vector& start, double factor, Vector& positions) {
  displacement_ = start + factor * step_;
  for (const Index dof : model_.free_dofs) positions[dof] = stage.origin[dof] + displacement_[dof];
}

/// Moves along the direction until the potential no longer falls, or not much steeper than it fell
/// at the start, and returns the share of the step taken. Works on the slope, which is known even
/// where a potential is not, and to more digits near the solution.
double Newton::line_search(const Stage& stage, Vector& positions) {
  constexpr int kTrials = 40;
  line_start_ = displacement_;
  const double start_slope = slope();
  double factor = 1.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    move(stage, line_start_, factor, positions);
    evaluate_residual(stage, positions);
    const double here = slope();
    if (!std::isfinite(here)) {
      factor *= 0.25;
      continue;
    }
    if (here <= 0.5 * std::abs(start_slope)) break;
    const double secant = std::abs(start_slope) / (std::abs(start_slope) + here);
    factor *= std::clamp(secant, 0.1, 0.7);
  }
  return factor;
}

double Newton::slope() const { return residual_.dot(step_); }

/// Shortens the step so that no edge changes by more than kLargestTurn of its rest length: an angle
/// for motion across the edge. Rigid translation does not count. Returns the change left; `step` is
/// the largest component.
double Newton::limit_turn(double& step) {
  double largest = 0.0;  // squared
  for (std::size_t i = 0; i < model_.edges.size(); ++i) {
    const auto& [x0, y0, x1, y1] = model_.edges[i].dofs;
    const double dx = step_[x1] - step_[x0];
    const double dy = step_[y1] - step_[y0];
    largest = std::max(largest, (dx * dx + dy * dy) * per_squared_length_[static_cast<Index>(i)]);
  }
  const double turn = std::sqrt(largest);
  if (turn <= kLargestTurn) return turn;
  const double share = kLargestTurn / turn;
  direction_ *= share;
  step_ *= share;
  step *= share;
  return kLargestTurn;
}

void Newton::measure(NewtonReport& report) const {
  report.residual = largest_magnitude(residual_, free_);
  report.force_scale = acting_;
}

/// The free degree of freedom with the largest residual, or the first whose residual is no number.
Index Newton::worst_dof() const {
  Index worst = -1;
  double largest = -1.0;
  for (const Index dof : model_.free_dofs) {
    const double here = std::abs(residual_[dof]);
    if (here <= largest) continue;
    worst = dof;
    if (!std::isfinite(here)) break;
    largest = here;
  }
  return worst;
}

}  // namespace der
