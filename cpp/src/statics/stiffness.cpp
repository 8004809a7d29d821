#include "der/statics/stiffness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "der/statics/potential.hpp"

namespace der {
namespace {

/// Rounding errors of the largest entry that assembling and factorising leave in an eigenvalue.
constexpr double kRoundings = 8.0;

}  // namespace

Stiffness::Stiffness(const Model& model, const Assembler& assembler, LinearSolver& solver)
    : model_(model),
      assembler_(assembler),
      solver_(solver),
      gradient_(Vector::Zero(model.num_dofs())),
      values_(Vector::Zero(assembler.num_values())),
      ones_{Vector::Ones(model.num_dofs()), {}} {}

void Stiffness::evaluate(const Vector& positions, const Vector& controls) {
  assembler_.gradient_and_hessian(positions, controls, gradient_, values_);
  positions_ = positions;
  controls_ = controls;
}

Inertia Stiffness::factorize(double shift, const Mass& mass) {
  constexpr int kTrials = 5;
  double nudge = rounding() / mass.lumped.lpNorm<Eigen::Infinity>() * 1e-2;
  Inertia inertia;
  for (int trial = 0; trial < kTrials && !inertia.factorised; ++trial, nudge *= 10.0) {
    shifted_ = values_;
    assembler_.add_mass(mass, trial == 0 ? shift : shift + nudge, shifted_);
    inertia = solver_.factorize(shifted_);
  }
  return inertia;
}

double Stiffness::rounding() const {
  // The spare slot at the end collects what belongs to held degrees of freedom.
  return kRoundings * std::numeric_limits<double>::epsilon() *
         values_.head(values_.size() - 1).lpNorm<Eigen::Infinity>();
}

Stability Stiffness::stability() {
  const double margin = rounding();
  Stability result;
  result.unstable_directions = factorize(margin).negative_pivots;
  result.neutral_directions =
      std::max<Index>(0, factorize(-margin).negative_pivots - result.unstable_directions);
  return result;
}

SoftDirection Stiffness::softest() {
  const auto positive = [&](double shift) {
    const Inertia inertia = factorize(shift);
    return inertia.factorised && inertia.negative_pivots == 0;
  };
  // The smallest shift that makes K positive definite, to about a third.
  double high = rounding();
  double low = 0.0;
  while (!positive(high) && std::isfinite(high)) {
    low = high;
    high *= 16.0;
  }
  for (int i = 0; low > 0.0 && i < 4; ++i) {
    const double middle = std::sqrt(low * high);
    (positive(middle) ? high : low) = middle;
  }
  factorize(high);
  return inverse_iteration();
}

SoftDirection Stiffness::nearest_to_zero() {
  factorize();
  return inverse_iteration();
}

SoftDirection Stiffness::inverse_iteration() {
  constexpr int kIterations = 40;
  constexpr double kSameDirection = 1e-10;  // 1 - cosine
  Vector x = unstructured_vector(model_.num_free()).normalized();
  Vector next = x;
  for (int i = 0; i < kIterations; ++i) {
    next = x;
    solver_.solve(next);
    next.normalize();
    const double cosine = std::abs(next.dot(x));
    x = next;
    if (1.0 - cosine < kSameDirection) break;
  }
  Eigen::Index largest = 0;
  x.cwiseAbs().maxCoeff(&largest);
  if (x[largest] < 0.0) x = -x;

  Vector full = Vector::Zero(model_.num_dofs());
  for (Index i = 0; i < model_.num_free(); ++i) {
    full[model_.free_dofs[static_cast<std::size_t>(i)]] = x[i];
  }
  return {x, second_variation(model_, controls_, positions_, full)};
}

Vector unstructured_vector(Index size) {
  std::mt19937 random(20080811);
  Vector x(size);
  for (Index i = 0; i < size; ++i) {
    x[i] = static_cast<double>(random()) / static_cast<double>(std::mt19937::max()) - 0.5;
  }
  return x;
}

}  // namespace der
