// Coefficients of the Runge-Kutta methods against the conditions that Taylor's theorem sets, one
// for each rooted tree (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I,
// table II.2.2).

#include "der/steppers/tableau.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <string>
#include <vector>

using namespace der;

namespace {

struct Method {
  const char* name;
  const Tableau& tableau;
  int order;
};
const std::vector<Method> kMethods{{"implicit_euler", kImplicitEuler, 1},
                                   {"implicit_midpoint", kImplicitMidpoint, 2},
                                   {"tr_bdf2", kTrBdf2, 2},
                                   {"sdirk4", kSdirk4, 4},
                                   {"sdirk5", kSdirk5, 5}};

/// One sum of the coefficients, and what it has to be for that order.
struct Condition {
  int order;
  double sum;
  double value;
};

Eigen::MatrixXd matrix(const Tableau& tableau) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(tableau.stages, tableau.stages);
  for (Index i = 0; i < tableau.stages; ++i) {
    for (Index j = 0; j < i; ++j) a(i, j) = tableau.below[to_size(i)][to_size(j)];
    if (tableau.is_implicit(i)) a(i, i) = tableau.diagonal;
  }
  return a;
}

Eigen::VectorXd weights(const Tableau& tableau) {
  return Eigen::Map<const Eigen::VectorXd>(tableau.weights.data(), tableau.stages);
}

std::vector<Condition> conditions(const Tableau& tableau) {
  const Eigen::MatrixXd a = matrix(tableau);
  const Eigen::VectorXd b = weights(tableau);
  const Eigen::ArrayXd c = a.rowwise().sum().array();
  const auto sum = [&](const Eigen::ArrayXd& stages) { return b.dot(stages.matrix()); };
  const auto times = [&](const Eigen::ArrayXd& stages) -> Eigen::ArrayXd {
    return (a * stages.matrix()).array();
  };
  const Eigen::ArrayXd ac = times(c);
  return {{1, b.sum(), 1.0},
          {2, sum(c), 1.0 / 2.0},
          {3, sum(c * c), 1.0 / 3.0},
          {3, sum(ac), 1.0 / 6.0},
          {4, sum(c * c * c), 1.0 / 4.0},
          {4, sum(c * ac), 1.0 / 8.0},
          {4, sum(times(c * c)), 1.0 / 12.0},
          {4, sum(times(ac)), 1.0 / 24.0},
          {5, sum(c * c * c * c), 1.0 / 5.0},
          {5, sum(c * c * ac), 1.0 / 10.0},
          {5, sum(ac * ac), 1.0 / 20.0},
          {5, sum(c * times(c * c)), 1.0 / 15.0},
          {5, sum(c * times(ac)), 1.0 / 30.0},
          {5, sum(times(c * c * c)), 1.0 / 20.0},
          {5, sum(times(c * ac)), 1.0 / 40.0},
          {5, sum(times(times(c * c))), 1.0 / 60.0},
          {5, sum(times(times(ac))), 1.0 / 120.0}};
}

}  // namespace

TEST_CASE("Runge-Kutta coefficients meet the conditions of their order, and no more") {
  for (const Method& method : kMethods) {
    CAPTURE(method.name);
    double next = 0.0;  // the largest violation one order higher
    for (const Condition& condition : conditions(method.tableau)) {
      CAPTURE(condition.order);
      const double error = std::abs(condition.sum - condition.value);
      // Rounding of sums of terms of the order of 10.
      if (condition.order <= method.order) CHECK(error < 1e-14);
      if (condition.order == method.order + 1) next = std::max(next, error);
    }
    if (method.order < 5) CHECK(next > 1e-4);
  }
}

TEST_CASE("L-stable methods leave nothing of very fast motion") {
  for (const Method& method : kMethods) {
    CAPTURE(method.name);
    const Tableau& tableau = method.tableau;
    // The stability function R(z) = 1 + z b' (I - z A)^-1 1, which falls as 1/z.
    const double z = -1e9;
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(tableau.stages);
    const Eigen::MatrixXd system =
        Eigen::MatrixXd::Identity(tableau.stages, tableau.stages) - z * matrix(tableau);
    const double left = 1.0 + z * weights(tableau).dot(system.lu().solve(ones));
    if (std::string(method.name) == "implicit_midpoint") {
      CHECK(left == doctest::Approx(-1.0));  // A-stable only: the fastest motion alternates
    } else {
      CHECK(std::abs(left) < 1e-6);
    }
  }
}
