// Difficult steps: line search, indefinite matrices, retries, and failures that say where and when.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "der/building/builder.hpp"
#include "der/core/error.hpp"
#include "der/loads/external_force.hpp"
#include "der/simulation.hpp"
#include "der/solvers/newton.hpp"
#include "der/solvers/stage.hpp"

namespace der::test {
namespace {

// A cantilever that a force against its axis, far above the buckling load, presses together.
const char* const kPressed = R"(
title: Pressed cantilever
rods:
  - name: rod
    nodes: 21
    from: [0, 0]
    to: [1, 0]
    cross_section: {stiffness: {EA: 1000, EI: 0.05, mass_per_length: 0.3}}
supports:
  - {rod: rod, at: start, clamp: true}
loads:
  - point_force: {rod: rod, at: end, force: [-20, 0.001]}
  - damping: {coefficient: 0.5}
time: {duration: 20, step: 0.05, integrator: implicit_euler}
)";

/// Residuals of the successive iterations of one static solve from the straight rod, over the
/// acting force and above rounding. A solve that takes steps of any length ends at the first
/// iterate whose residual is below the tolerance: each tolerance is a little below what the one
/// before has given.
std::vector<double> residuals_of_newton(const Scenario& scenario) {
  const Model model = build_model(scenario.scene());
  const Pattern pattern = build_pattern(model);
  const LinearSolverChoice linear = make_linear_solver("banded", pattern);
  const Assembler assembler(model, linear.solver->layout());
  const State start = initial_state(model);
  Stage stage(model);
  Configuration here = configuration_of(model, start);
  external_force(model, here, start.extra_force, stage.force);
  StageProblem problem(model, assembler, model.mass);
  problem.pose(stage, here);
  std::vector<double> residuals{1.0};
  for (;;) {
    NewtonOptions options;
    options.step_tolerance = std::numeric_limits<double>::infinity();
    options.residual_tolerance = 0.999 * residuals.back();
    Newton newton(model.dofs, *linear.solver, assembler.num_values(), options);
    here.coordinates = start.positions;
    const NewtonReport report = newton.solve(problem);
    REQUIRE(report.converged);
    const double residual = report.residual / report.force_scale;
    if (residual < 1e-11 || residual >= residuals.back()) return residuals;  // rounding
    residuals.push_back(residual);
  }
}

Scenario pressed(const std::string& force, const std::string& EA) {
  return Scenario::parse(kPressed, "scene",
                         {{"time", ""},
                          {"analysis", "static"},
                          {"rods.rod.cross_section.stiffness.EA", EA},
                          {"loads.0.point_force.force", force}});
}

/// r(k + 1) <= c r(k)^2, the force being the unit.
void check_quadratic(const std::vector<double>& residuals, double c) {
  int checked = 0;
  for (std::size_t k = 1; k + 1 < residuals.size(); ++k) {
    if (residuals[k] > 0.1) continue;
    CHECK(residuals[k + 1] <= c * residuals[k] * residuals[k]);
    ++checked;
  }
  CHECK(checked >= 1);
}

}  // namespace

TEST_CASE("an indefinite stiffness leads away from the straight rod, to a stable shape") {
  Simulation simulation(Scenario::parse(kPressed));
  while (!simulation.finished()) simulation.step();
  // Pulled through: the rod has reversed and hangs behind the clamp along the force.
  const Vector& x = simulation.state().positions;
  CHECK(x[x.size() - 2] < -0.8);
  CHECK(simulation.equilibrium().stability.unstable_directions == 0);
}

TEST_CASE("a step that cannot be solved is retried in smaller ones, then named") {
  // One iteration a step is enough for a small step only.
  Simulation simulation(Scenario::parse(
      kPressed, "scene", {{"solver.max_iterations", "1"}, {"time.minimum_step", "0.02"}}));
  std::string message;
  double last_good = -1.0;
  try {
    while (!simulation.finished()) {
      last_good = simulation.state().time;
      simulation.step();
    }
  } catch (const NotConvergedError& error) {
    message = error.what();
  }
  CHECK(message.find("a step from t = ") != std::string::npos);
  CHECK(message.find("of rod 'rod'") != std::string::npos);
  CHECK(simulation.counters().retried_steps > 0);
  CHECK(simulation.state().time == last_good);
  CHECK(simulation.state().positions.allFinite());
}

TEST_CASE("steps that rounding keeps long are short enough") {
  // 800 edges in space: rounding of the forces alone makes Newton's steps 1e-12 of the size.
  const auto found = [](const char* tolerance) {
    Simulation simulation(Scenario::parse(R"(
title: Cantilever in space
rods:
  - name: rod
    nodes: 801
    from: [0, 0, 0]
    to: [1, 0, 0]
    cross_section: {stiffness: {EA: 1e6, EI: 1, GJ: 0.7, mass_per_length: 1}}
supports: [{rod: rod, at: start, clamp: true}]
loads:
  - point_force: {rod: rod, at: end, force: [0.1, 1, 0.5]}
  - moment: {rod: rod, at: end, moment: [0.3, 0, 0.1]}
analysis: static
)",
                                          "scene", {{"solver.step_tolerance", tolerance}}));
    const EquilibriumReport report = simulation.equilibrium();
    return std::make_pair(simulation.state().positions, report.newton_iterations);
  };
  const auto [usual, iterations] = found("1e-9");
  const auto [tight, more] = found("1e-16");
  CHECK((tight - usual).lpNorm<Eigen::Infinity>() < 1e-9);
  CHECK(more < 2 * iterations);
}

TEST_CASE("a retried step ends where a run with small steps ends") {
  // A gentle push across the axis: two iterations do not solve a step of 50 ms, but its pieces.
  // Each piece is at least as accurate as the whole step, which is off by 3e-4 m here.
  const auto end = [](const std::string& step, const std::string& iterations) {
    Simulation simulation(Scenario::parse(kPressed, "scene",
                                          {{"loads.0.point_force.force", "[0, 0.1]"},
                                           {"loads.1.damping.coefficient", "2"},
                                           {"time.step", step},
                                           {"time.duration", "0.6"},
                                           {"time.integrator", "tr_bdf2"},
                                           {"solver.max_iterations", iterations}}));
    while (!simulation.finished()) simulation.step();
    CHECK(simulation.state().time == 0.6);
    return std::make_pair(simulation.state().positions, simulation.counters().retried_steps);
  };
  const auto [whole, none] = end("0.05", "50");
  const auto [pieces, retried] = end("0.05", "2");
  const auto [fine, still_none] = end("0.00078125", "50");
  CHECK(none == 0);
  CHECK(still_none == 0);
  CHECK(retried > 0);
  CHECK((pieces - fine).lpNorm<Eigen::Infinity>() <= (whole - fine).lpNorm<Eigen::Infinity>());
}

TEST_CASE("Newton's method converges quadratically near the solution") {
  for (const char* force : {"[0, 0.02]", "[0, 0.1]", "[0, 0.5]"}) {
    for (const char* EA : {"1", "20"}) {
      CAPTURE(force);
      CAPTURE(EA);
      const std::vector<double> residuals = residuals_of_newton(pressed(force, EA));
      check_quadratic(residuals, 3.0);  // measured: from 0.002 to 1
      CHECK(residuals.back() < 1e-5);
    }
  }
}

TEST_CASE("Newton's method converges quadratically under loads without a potential") {
  const char* const kLoaded = R"(
rods:
  - name: rod
    nodes: 13
    from: [0, 0, 0]
    to: [1, 0, 0]
    cross_section: {stiffness: {EA: 20, EI1: 1, EI2: 2, GJ: 0.8, mass_per_length: 1}, director: [0, 1, 0]}
supports:
  - {rod: rod, at: start, clamp: true}
loads:
  - point_force: {rod: rod, at: end, force: [-0.2, 0.5, 0.3], follower: true}
  - point_force: {rod: rod, at: 0.43, force: [0, 0.3, 0.2], follower: true}
  - moment: {rod: rod, at: end, moment: [0.3, 0.4, -0.2]}
  - moment: {rod: rod, at: 0.72, moment: [0.2, 0.1, 0.3], follower: true}
analysis: static
)";
  check_quadratic(residuals_of_newton(Scenario::parse(kLoaded)), 3.0);
  check_quadratic(residuals_of_newton(Scenario::parse(kLoaded, "scene",
                                                      {{"model", "planar"},
                                                       {"loads",
                                                        "[{point_force: {rod: rod, at: end, force: "
                                                        "[-0.2, 0.8, 0], follower: true}}]"}})),
                  3.0);
}

}  // namespace der::test
