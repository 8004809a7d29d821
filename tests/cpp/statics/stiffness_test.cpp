// What rounding leaves of the smallest eigenvalues of a stiffness.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "der/assembly/assembler.hpp"
#include "der/building/builder.hpp"
#include "der/catalog/linear_solvers.hpp"
#include "der/model/state.hpp"
#include "der/simulation.hpp"
#include "der/solvers/linear_solver.hpp"
#include "der/statics/stiffness.hpp"

namespace der::test {
namespace {

/// The rounding [N/m] of a rod in space whose lengths are written in a unit of `unit` metres.
double rounding_in(double unit) {
  const Model model = build_model(
      Scenario::parse(
          fmt::format(
              "title: t\nmodel: spatial\nrods:\n  - {{name: rod, nodes: 9, from: [0, 0, 0], "
              "to: [{0}, 0, 0], cross_section: {{stiffness: {{EA: 1e3, EI: {1}, GJ: {1}, "
              "mass_per_length: 1}}}}}}\n"
              "supports:\n  - {{rod: rod, at: start, clamp: true}}\nanalysis: static\n",
              unit, unit * unit))
          .scene());
  const Pattern pattern = build_pattern(model);
  const LinearSolverChoice linear = make_linear_solver("banded", pattern);
  const Assembler assembler(model, linear.solver->layout());
  Stiffness stiffness(model, assembler, *linear.solver);
  stiffness.evaluate(configuration_of(model, initial_state(model)));
  return stiffness.rounding();
}

}  // namespace

TEST_CASE("the rounding of a stiffness is that of its forces, whatever the unit of length") {
  // Powers of 2 change nothing but exponents; moments over angles grow with the square of the unit.
  const double in_metres = rounding_in(1.0);
  for (const double unit : {1.0 / 1048576.0, 1024.0, 1048576.0}) {
    CHECK(rounding_in(unit) * unit == in_metres);
  }
}

}  // namespace der::test
