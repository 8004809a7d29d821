// Every linear solver against dense algebra, and against each other on every scene of configs/.
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "der/building/builder.hpp"
#include "der/catalog/linear_solvers.hpp"
#include "der/core/error.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der::test {
namespace {

bool built_in(const std::string& name, const Pattern& pattern) {
  try {
    make_linear_solver(name, pattern);
    return true;
  } catch (const Error& error) {
    return error.status() != "not_available";
  }
}

constexpr Elimination kOrders[] = {Elimination::FromBothEnds, Elimination::FromStart};

/// A full band of the given width.
Pattern band_pattern(Index size, Index half_bandwidth) {
  Pattern pattern;
  pattern.size = size;
  pattern.half_bandwidth = half_bandwidth;
  pattern.outer.push_back(0);
  for (Index j = 0; j < size; ++j) {
    for (Index i = j; i < std::min(size, j + half_bandwidth + 1); ++i) pattern.inner.push_back(i);
    pattern.outer.push_back(pattern.nonzeros());
  }
  return pattern;
}

Vector values_of(const Eigen::MatrixXd& dense, const Pattern& pattern, const MatrixLayout& layout) {
  Vector values = Vector::Zero(layout.num_values() + 1);
  for (Index j = 0; j < pattern.size; ++j) {
    for (Index k = pattern.outer[static_cast<std::size_t>(j)];
         k < pattern.outer[static_cast<std::size_t>(j) + 1]; ++k) {
      const Index i = pattern.inner[static_cast<std::size_t>(k)];
      values[layout.slot(i, j)] = dense(i, j);
    }
  }
  return values;
}

/// Two rings between parts of an open chain, and after each other: a band that the last rows of a
/// ring leave.
Pattern rings_pattern(Index half_bandwidth, Index border_rows) {
  Pattern pattern;
  pattern.size = 90;
  pattern.half_bandwidth = half_bandwidth;
  pattern.borders = {{10, 40 - border_rows, 40}, {40, 80 - border_rows, 80}};
  const auto part_of = [](Index i) { return (i >= 10) + (i >= 40) + (i >= 80); };
  const auto is_of_border = [&](Index i) {
    return (i >= 40 - border_rows && i < 40) || (i >= 80 - border_rows && i < 80);
  };
  pattern.outer.push_back(0);
  for (Index j = 0; j < pattern.size; ++j) {
    for (Index i = j; i < pattern.size; ++i) {
      if (part_of(i) != part_of(j)) continue;
      if (i - j <= half_bandwidth || is_of_border(i)) pattern.inner.push_back(i);
    }
    pattern.outer.push_back(pattern.nonzeros());
  }
  return pattern;
}

void compare_with_dense_algebra(const Pattern& pattern) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(pattern.size, pattern.size);
  for (Index j = 0; j < pattern.size; ++j) {
    for (Index k = pattern.outer[static_cast<std::size_t>(j)];
         k < pattern.outer[static_cast<std::size_t>(j) + 1]; ++k) {
      const Index i = pattern.inner[static_cast<std::size_t>(k)];
      dense(i, j) = dense(j, i) = uniform(random);
    }
  }
  for (Index j = 0; j < pattern.size; ++j) {
    // Dominant, so that no pivoting is needed, and of either sign.
    const double others = dense.row(j).cwiseAbs().sum();
    dense(j, j) = (j % 7 == 3 ? -1.0 : 1.0) * (others + 2.0);
  }
  const Vector b = Vector::Random(pattern.size);
  const Vector expected = dense.fullPivLu().solve(b);
  const auto negative =
      (Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues().array() < 0.0).count();
  for (const std::string& name : linear_solver_names()) {
    if (!built_in(name, pattern)) continue;
    CAPTURE(name);
    for (const Elimination order : kOrders) {
      const LinearSolverChoice choice = make_linear_solver(name, pattern, order);
      // Twice: nothing may be left of the first time.
      for (int time = 0; time < 2; ++time) {
        const Inertia inertia =
            choice.solver->factorize(values_of(dense, pattern, choice.solver->layout()));
        REQUIRE(inertia.factorised);
        CHECK(inertia.negative_pivots == negative);
        Vector x = b;
        choice.solver->solve(x);
        CHECK((x - expected).norm() < 1e-12 * expected.norm());
      }
    }
  }
}

}  // namespace

TEST_CASE("every linear solver solves and counts negative eigenvalues as dense algebra does") {
  // 5, 8 and 10 have two halves, of the same number of rows or not.
  struct Band {
    Index width;
    Index size;
  };
  for (const Band& band :
       {Band{0, 40}, {1, 40}, {3, 40}, {5, 40}, {5, 41}, {8, 40}, {8, 41}, {10, 40}, {10, 41}}) {
    CAPTURE(band.width);
    CAPTURE(band.size);
    compare_with_dense_algebra(band_pattern(band.size, band.width));
  }
}

TEST_CASE("so it does with the borders of rings") {
  struct Rings {
    Index width;
    Index rows;
  };
  for (const Rings& rings : {Rings{5, 4}, {8, 6}, {10, 7}, {6, 5}, {9, 2}}) {
    CAPTURE(rings.width);
    CAPTURE(rings.rows);
    compare_with_dense_algebra(rings_pattern(rings.width, rings.rows));
  }
}

TEST_CASE("the matrix of a ring is a narrow band with a narrow border") {
  const auto pattern_of = [](const std::string& model) {
    const Scenario scenario = Scenario::parse("model: " + model + R"(
rods:
  - name: ring
    points: [[1, 0, 0], [0.7, 0.7, 0], [0, 1, 0], [-0.7, 0.7, 0], [-1, 0, 0], [-0.7, -0.7, 0],
             [0, -1, 0], [0.7, -0.7, 0]]
    closed: true
    cross_section: {stiffness: {EA: 100, EI: 1, GJ: 1, mass_per_length: 1}}
    natural_curvature: [0, 0]
analysis: static
)");
    return build_pattern(build_model(scenario.scene()));
  };
  struct Expected {
    const char* model;
    Index half_bandwidth;
    Index border_rows;
  };
  for (const Expected& expected :
       {Expected{"planar", 5, 4}, {"spatial_bend", 8, 6}, {"spatial", 10, 7}}) {
    CAPTURE(expected.model);
    const Pattern pattern = pattern_of(expected.model);
    CHECK(pattern.half_bandwidth == expected.half_bandwidth);
    REQUIRE(pattern.borders.size() == 1);
    CHECK(pattern.borders[0].rows() == expected.border_rows);
  }
}

TEST_CASE("a vanishing pivot is reported, not divided by") {
  const Pattern pattern = band_pattern(4, 1);
  for (const std::string& name : linear_solver_names()) {
    if (!built_in(name, pattern)) continue;
    CAPTURE(name);
    const LinearSolverChoice choice = make_linear_solver(name, pattern);
    const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(4, 4);
    CHECK_FALSE(
        choice.solver->factorize(values_of(zero, pattern, choice.solver->layout())).factorised);
  }
}

TEST_CASE("the band solver says which pivot vanishes, in either half and between them") {
  for (const Index size : {40, 41}) {
    for (const Elimination order : kOrders) {
      const Pattern pattern = band_pattern(size, 5);
      const LinearSolverChoice choice = make_linear_solver("banded", pattern, order);
      for (const Index row : {0, 3, 17, 20, 22, 30, size - 1}) {
        Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(size, size);
        dense(row, row) = 0.0;
        const Inertia inertia =
            choice.solver->factorize(values_of(dense, pattern, choice.solver->layout()));
        CHECK_FALSE(inertia.factorised);
        CHECK(inertia.failed_at == row);
      }
    }
  }
}

TEST_CASE("all linear solvers lead to the same motion, to 1e-10, on every scene") {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(DER_SOURCE_DIR "/configs")) {
    const Scenario scenario = Scenario::load(entry.path());
    const Pattern pattern = build_pattern(build_model(scenario.scene()));
    Vector expected;
    for (const std::string& name : linear_solver_names()) {
      if (!built_in(name, pattern)) continue;
      CAPTURE(entry.path().string());
      CAPTURE(name);
      Simulation simulation(scenario.with({{"solver.linear", name}}));
      if (!scenario.scene().is_dynamic()) {
        simulation.equilibrium();
      } else {
        for (int i = 0; i < 20; ++i) simulation.step();
      }
      // Angles of sections count from directors that depend on the way of the search.
      const Vector positions =
          simulation.state().positions.head(simulation.model().dofs.num_positions());
      if (expected.size() == 0) expected = positions;
      CHECK((positions - expected).lpNorm<Eigen::Infinity>() < 1e-10 * simulation.model().size());
    }
    ++scenes;
  }
  CHECK(scenes >= 10);
}

}  // namespace der::test
