#include "der/solvers/newton.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/solvers/newton_step.hpp"

namespace der {
namespace {

/// A step to a solution near by changes no edge by more than this [rad]: near a critical load a
/// longer one leads past it.
constexpr double kNearbyChange = 0.05;

/// Calls use(entry, unit_mass) for each entry of the diagonal.
template <class Values, class Use>
void for_each_on_diagonal(const DofMap& dofs, const MatrixLayout& layout, Values& values,
                          const Use& use) {
  for (Index i = 0; i < dofs.num_free(); ++i) {
    use(values[layout.slot(i, i)], dofs.unit_mass(dofs.free()[to_size(i)]));
  }
}

/// The largest stiffness on the diagonal [N/m], by size.
double largest_on_diagonal(const DofMap& dofs, const MatrixLayout& layout, const Vector& values) {
  double largest = 0.0;
  for_each_on_diagonal(dofs, layout, values, [&](double entry, double unit_mass) {
    largest = std::max(largest, std::abs(entry) / unit_mass);
  });
  return largest;
}

}  // namespace

Newton::Newton(const DofMap& dofs, LinearSolver& solver, Index num_values,
               const NewtonOptions& options, CancelCallback beat)
    : dofs_(dofs),
      solver_(solver),
      corrected_(solver, dofs.num_free()),
      options_(options),
      beat_(std::move(beat)),
      residual_(Vector::Zero(dofs.size())),
      values_(Vector::Zero(num_values)),
      direction_(Vector::Zero(dofs.num_free())),
      step_(Vector::Zero(dofs.size())),
      displacement_(Vector::Zero(dofs.size())),
      line_start_(Vector::Zero(dofs.size())) {}

NewtonReport Newton::solve(NewtonProblem& problem) {
  last_shift_ = 0.0;  // a step must not depend on those before but by the state
  problem.begin(displacement_);
  NewtonReport report = iterate(problem, Mode::FullSteps);
  if (report.converged) return report;

  const int spent = report.iterations;
  problem.begin_again(displacement_);
  report = solve_downhill(problem);
  report.iterations += spent;
  return report;
}

NewtonReport Newton::solve_downhill(NewtonProblem& problem) {
  problem.begin(displacement_);
  NewtonReport report = iterate(problem, Mode::LineSearch);
  if (!report.converged) {
    // The displacement stays that of the last iterate, whose residual is reported.
    line_start_ = displacement_;
    problem.begin_again(line_start_);
  }
  return report;
}

NewtonReport Newton::solve_nearby(NewtonProblem& problem) {
  last_shift_ = 0.0;
  problem.begin(displacement_);
  const NewtonReport report = iterate(problem, Mode::Nearby);
  if (!report.converged) problem.begin_again(displacement_);
  return report;
}

NewtonReport Newton::iterate(NewtonProblem& problem, Mode mode) {
  const bool takes_full_steps = mode != Mode::LineSearch;
  const int limit = mode == Mode::FullSteps ? std::min(kFullStepIterations, options_.max_iterations)
                                            : options_.max_iterations;
  NewtonReport report;
  problem.system(residual_, values_);
  measure(problem, report);
  if (mode == Mode::Nearby) predict_mixed_point(problem, report);
  while (report.iterations < limit) {
    if (beat_) beat_();
    const double residual_before = report.residual;
    if (!std::isfinite(residual_before) || !find_direction(problem, mode, report)) {
      report.worst_dof = worst_dof();
      report.failure = "the forces or the stiffness stopped being numbers";
      return report;
    }
    ++report.iterations;
    double step = length_;
    bool have_system = false;
    if (takes_full_steps) {
      move(problem, displacement_, taken_);
      have_system = step > kNearSolution * dofs_.length();
      if (have_system) {
        problem.system(residual_, values_);
        problem.mixed_point_update(step_, taken_, values_);
      } else {
        problem.residual(residual_);
      }
    } else {
      step *= line_search(problem);
    }
    measure(problem, report);

    const auto [is_short, is_stalled] =
        progress_of({step, change_, residual_before, report.residual}, options_.step_tolerance,
                    dofs_.length(), [&] { return problem.position_rounding(); });
    if (is_short || is_stalled) {
      report.converged =
          is_short && report.residual <= options_.residual_tolerance * report.force_scale;
      if (!report.converged) {
        report.converged = report.residual <= problem.residual_rounding(values_);
        have_system = false;
      }
      if (report.converged) return report;
    }
    if (have_system) continue;
    problem.system(residual_, values_);
    if (takes_full_steps) problem.mixed_point_update(step_, taken_, values_);
  }
  report.worst_dof = worst_dof();
  report.failure = "no convergence in " + std::to_string(options_.max_iterations) + " iterations";
  return report;
}

/// Puts into the matrix at the guess what a step with nothing in its place predicts. What the guess
/// has there may be false: the edges between points of a curve are its chords, too short by so
/// little that no one sees it, and yet pressed far above any buckling load.
void Newton::predict_mixed_point(NewtonProblem& problem, NewtonReport& report) {
  problem.remove_mixed_point_part(values_);
  const bool found = find_direction(problem, Mode::Nearby, report);
  ++report.iterations;
  problem.system(residual_, values_);
  if (found) problem.mixed_point_update(step_, 0.0, values_);
}

/// Factorises the current matrix, shifted where it is singular or, if it has to be `positive`, not
/// positive definite. False: its entries are not numbers.
bool Newton::factorize(bool positive, NewtonReport& report) {
  Inertia inertia = solver_.factorize(values_);
  report.negative_pivots = inertia.negative_pivots;
  if (inertia.factorised && (!positive || inertia.negative_pivots == 0)) return true;
  // Shift by ever more until positive definite, starting a little below the last shift needed.
  if (!std::isfinite(values_.lpNorm<Eigen::Infinity>())) return false;
  const double largest = largest_on_diagonal(dofs_, solver_.layout(), values_);
  double shift = std::max(1e-12 * largest, 0.1 * last_shift_);
  double applied = 0.0;
  do {
    for_each_on_diagonal(dofs_, solver_.layout(), values_, [&](double& entry, double unit_mass) {
      entry += (shift - applied) * unit_mass;
    });
    applied = shift;
    shift *= 4.0;
    inertia = solver_.factorize(values_);
  } while ((!inertia.factorised || inertia.negative_pivots > 0) && applied < 1e3 * largest);
  last_shift_ = applied;
  return inertia.factorised;
}

/// Sets the step, as far as the problem admits; that to a solution near by as a whole, of which
/// `taken_` is admitted. False: there is none, or it is not a number.
bool Newton::find_direction(NewtonProblem& problem, Mode mode, NewtonReport& report) {
  const LowRank* unsymmetric = problem.low_rank();
  const bool downhill = mode == Mode::FullSteps ? unsymmetric == nullptr : mode == Mode::LineSearch;
  if (!factorize(downhill, report)) return false;
  const auto& free = dofs_.free();
  for (std::size_t i = 0; i < free.size(); ++i) {
    direction_[static_cast<Index>(i)] = -residual_[free[i]];
  }
  if (unsymmetric == nullptr) {
    solver_.solve(direction_);
  } else {
    corrected_.factorize(*unsymmetric);
    corrected_.solve(direction_);
  }
  for (std::size_t i = 0; i < free.size(); ++i) {
    step_[free[i]] = direction_[static_cast<Index>(i)];
  }
  length_ = dofs_.largest_motion(step_);
  if (!std::isfinite(length_)) return false;
  const StepBound bound = problem.largest_step(step_);
  taken_ = 1.0;
  if (mode == Mode::Nearby) {
    taken_ = bound.share * std::min(1.0, kNearbyChange / bound.change);
    change_ = std::min(bound.change, kNearbyChange);
    length_ *= taken_;
    return true;
  }
  change_ = bound.change;
  if (bound.share < 1.0) {
    step_ *= bound.share;
    length_ *= bound.share;
  }
  return true;
}

void Newton::move(NewtonProblem& problem, const Vector& start, double factor) {
  displacement_ = start + factor * step_;
  problem.solution_changed(displacement_);
}

/// Moves along the direction until the potential no longer falls, or not much steeper than it fell
/// at the start, and returns the share of the step taken. Works on the slope, which is known even
/// where a potential is not, and to more digits near the solution.
double Newton::line_search(NewtonProblem& problem) {
  constexpr int kTrials = 40;
  line_start_ = displacement_;
  const double start_slope = slope();
  double factor = 1.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    move(problem, line_start_, factor);
    problem.residual(residual_);
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

void Newton::measure(const NewtonProblem& problem, NewtonReport& report) const {
  report.residual = dofs_.largest_free_force(residual_);
  report.force_scale = problem.acting_force();
}

/// The free degree of freedom with the largest residual, or the first whose residual is not finite.
Index Newton::worst_dof() const {
  Index worst = -1;
  double largest = -1.0;
  for (const Index dof : dofs_.free()) {
    const double here = dofs_.force_of(dof, residual_[dof]);
    if (here <= largest) continue;
    worst = dof;
    if (!std::isfinite(here)) break;
    largest = here;
  }
  return worst;
}

}  // namespace der
