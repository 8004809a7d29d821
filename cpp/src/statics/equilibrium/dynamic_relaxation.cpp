#include "statics/equilibrium/dynamic_relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "der/statics/potential.hpp"

namespace der::statics {
namespace {

constexpr int kMaxTimeSteps = 3000;
/// A step changes no edge by more than this [rad].
constexpr double kLargestStepChange = 0.2;
/// The relaxation gives up when the step has shrunk to this fraction of the first one.
constexpr double kSmallestTimeStep = 1e-6;
/// Damping coefficient times the first step.
constexpr double kDamping = 0.3;
constexpr double kGrowth = 1.2;
/// A plain Newton step is tried once a step changes no edge by more than this [rad], and, if it
/// fails, again when the change has halved.
constexpr double kCalmEnough = 0.1;

/// The time in which the largest force moves a unit mass by about the size of the model.
double first_time_step(const Model& model, const StaticLoads& loads, Stiffness& stiffness,
                       const Shape& shape) {
  stiffness.evaluate(loads.at(model, shape));
  const double acting = std::max(model.dofs.largest_force(loads.force),
                                 model.dofs.largest_force(stiffness.gradient()));
  return std::sqrt(model.size() / acting);
}

}  // namespace

bool relax_dynamically(const Model& model, const StaticLoads& loads, StaticNewton& newton,
                       Stiffness& stiffness, Shape& shape, int& steps) {
  Shape now = shape;
  Vector velocity = Vector::Zero(now.positions.size());
  double step = first_time_step(model, loads, stiffness, now);
  const double damping = kDamping / step;
  const double smallest = kSmallestTimeStep * step;
  double change_for_newton = kCalmEnough;
  Stage stage = newton.stage_of(loads);
  Configuration here = loads.at(model, now);
  for (int i = 0; i < kMaxTimeSteps && step > smallest; ++i) {
    ++steps;
    const double damped = 1.0 + damping * step;
    stage.inertia = damped / (step * step);
    stage.inertia_target = now.positions + step / damped * velocity;
    here.coordinates = now.positions;
    const bool solved = !newton.solve(stage, here);
    const double change =
        solved ? largest_edge_change(model, here.coordinates - now.positions) : 0.0;
    if (!solved || change > kLargestStepChange) {
      step *= 0.5;
      continue;
    }
    velocity = (here.coordinates - now.positions) / step;
    now.positions = here.coordinates;
    loads.follow(model, now);
    here = loads.at(model, now);
    if (change < 0.5 * kLargestStepChange) step *= kGrowth;
    if (change < change_for_newton) {
      if (newton.balance_nearby(loads, now).reached) {
        shape = std::move(now);
        return true;
      }
      change_for_newton *= 0.5;
    }
  }
  return false;
}

}  // namespace der::statics
