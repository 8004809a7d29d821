// The cost of one Newton iteration (gradient, Hessian, factorisation, solution) of each model
// against one bare factorisation and solution of the same matrix by Eigen's SimplicialLDLT with its
// natural ordering, the pattern analysed before. Run it and compare lines of one run: machines
// differ. Arguments: nodes; model (0: planar, 1: spatial_bend, 2: spatial); 1 of a ring.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "der/assembly/assembler.hpp"
#include "der/building/builder.hpp"
#include "der/core/constants.hpp"
#include "der/model/state.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {
namespace {

/// A cantilever whose shape waves a little, so that no angle is zero, or a free ring that does.
scenario::Scene cantilever(int nodes, scenario::ModelChoice model, bool closed) {
  const bool planar = model == scenario::ModelChoice::Planar;
  scenario::Scene scene;
  scene.model = model;
  scene.dimension = planar ? 2 : 3;
  scenario::Rod rod;
  rod.name = "rod";
  for (int i = 0; i < nodes; ++i) {
    const double s = static_cast<double>(i) / (closed ? nodes : nodes - 1);
    rod.points.push_back({s, 0.01 * std::sin(20.0 * s)});
    if (closed) {
      const double angle = 2.0 * kPi * s;
      const double radius = (1.0 + 0.05 * std::sin(3.0 * angle)) / (2.0 * kPi);
      rod.points.back() = {radius * std::cos(angle), radius * std::sin(angle)};
    }
    if (!planar) rod.points.back().push_back(0.01 * std::sin(23.0 * s));
  }
  rod.cross_section = scenario::Circle{0.01};
  if (model == scenario::ModelChoice::Spatial) {
    rod.cross_section = scenario::Rectangle{0.02, 0.01};
    rod.director = scenario::Components{0.0, 0.0, 1.0};
  }
  rod.material = scenario::Material{1e7, 1000.0, 0.3, {}, {}};
  rod.natural_curvature = 0.0;
  if (model == scenario::ModelChoice::Spatial) {
    rod.natural_curvature = scenario::CurvaturePair{};
  }
  rod.closed = closed;
  scene.rods.push_back(rod);
  scenario::Support support;
  support.rod = "rod";
  support.clamp = planar ? scenario::Clamp::Section : scenario::Clamp::Tangent;
  if (model == scenario::ModelChoice::Spatial) support.clamp = scenario::Clamp::Section;
  if (!closed) scene.supports.push_back(support);
  scenario::Gravity gravity;
  gravity.acceleration.values = {planar ? scenario::Components{0.0, -9.81}
                                        : scenario::Components{0.0, -9.81, 0.0}};
  scene.loads.emplace_back().what = gravity;
  return scene;
}

constexpr std::array kModels{scenario::ModelChoice::Planar, scenario::ModelChoice::SpatialBend,
                             scenario::ModelChoice::Spatial};

constexpr double kInertia = 1e6;  // [1/s^2], of a time step of 1 ms

struct Problem {
  explicit Problem(const benchmark::State& state)
      : model(build_model(cantilever(static_cast<int>(state.range(0)),
                                     kModels[static_cast<std::size_t>(state.range(1))],
                                     state.range(2) != 0))),
        pattern(build_pattern(model)),
        solver(make_linear_solver("banded", pattern, Elimination::FromBothEnds).solver),
        assembler(model, solver->layout()),
        here(configuration_of(model, initial_state(model))),
        gradient(Vector::Zero(model.num_dofs())),
        values(Vector::Zero(assembler.num_values())),
        mass_values(values),
        right_side(Vector::Zero(model.num_free())) {
    assembler.add_mass(model.mass, 1.0, mass_values);
  }

  void assemble() {
    values = kInertia * mass_values;
    assembler.add_hessian(here, gradient, values);
  }

  void newton_iteration() {
    assemble();
    benchmark::DoNotOptimize(solver->factorize(values));
    for (Index i = 0; i < model.num_free(); ++i) {
      right_side[i] = -gradient[model.dofs.free()[static_cast<std::size_t>(i)]];
    }
    solver->solve(right_side);
    benchmark::DoNotOptimize(right_side.data());
  }

  Model model;
  Pattern pattern;
  std::unique_ptr<LinearSolver> solver;
  Assembler assembler;
  Configuration here;
  Vector gradient;
  Vector values;
  Vector mass_values;
  Vector right_side;
};

void count_nodes(benchmark::State& state) {
  state.counters["per_node"] =
      benchmark::Counter(static_cast<double>(state.iterations() * state.range(0)),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void newton_iteration(benchmark::State& state) {
  Problem problem(state);
  for (auto _ : state) problem.newton_iteration();
  count_nodes(state);
}

void assembly_alone(benchmark::State& state) {
  Problem problem(state);
  for (auto _ : state) {
    problem.assemble();
    benchmark::DoNotOptimize(problem.values.data());
  }
  count_nodes(state);
}

void residual_alone(benchmark::State& state) {
  Problem problem(state);
  for (auto _ : state) {
    problem.assembler.gradient(problem.here, problem.gradient);
    benchmark::DoNotOptimize(problem.gradient.data());
  }
  count_nodes(state);
}

void banded_solve_alone(benchmark::State& state) {
  Problem problem(state);
  problem.assemble();
  for (auto _ : state) {
    benchmark::DoNotOptimize(problem.solver->factorize(problem.values));
    problem.solver->solve(problem.right_side);
    benchmark::DoNotOptimize(problem.right_side.data());
  }
  count_nodes(state);
}

void eigen_simplicial_ldlt(benchmark::State& state) {
  Problem problem(state);
  problem.assemble();
  using Matrix = Eigen::SparseMatrix<double>;
  std::vector<Eigen::Triplet<double>> triplets;
  const Index size = problem.model.num_free();
  for (Index j = 0; j < size; ++j) {
    for (Index k = problem.pattern.outer[static_cast<std::size_t>(j)];
         k < problem.pattern.outer[static_cast<std::size_t>(j) + 1]; ++k) {
      const Index i = problem.pattern.inner[static_cast<std::size_t>(k)];
      triplets.emplace_back(i, j, problem.values[problem.solver->layout().slot(i, j)]);
    }
  }
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower, Eigen::NaturalOrdering<int>> ldlt;
  ldlt.analyzePattern(matrix);
  const Vector right_side = Vector::Ones(size);
  Vector solution(size);
  for (auto _ : state) {
    ldlt.factorize(matrix);
    solution = ldlt.solve(right_side);
    benchmark::DoNotOptimize(solution.data());
  }
  count_nodes(state);
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int ring : {0, 1}) {
    for (const int model : {0, 1, 2}) {
      for (const int nodes : {51, 101, 401, 1601}) benchmark->Args({nodes, model, ring});
    }
  }
}

BENCHMARK(newton_iteration)->Apply(sizes);
BENCHMARK(eigen_simplicial_ldlt)->Apply(sizes);
BENCHMARK(assembly_alone)->Apply(sizes);
BENCHMARK(residual_alone)->Apply(sizes);
BENCHMARK(banded_solve_alone)->Apply(sizes);

}  // namespace
}  // namespace der

BENCHMARK_MAIN();
