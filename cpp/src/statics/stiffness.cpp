#include "der/statics/stiffness.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "der/core/index.hpp"
#include "der/model/dimension.hpp"
#include "der/statics/potential.hpp"

namespace der {
namespace {

/// Rounding errors of the largest entry that assembling and factorising leave in an eigenvalue.
constexpr double kRoundings = 8.0;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Eigenvalues of more than so many rounding errors are clear of them.
constexpr double kClear = 1e3;
/// Doubtful directions are examined one by one only up to this number.
constexpr Index kMostDoubtful = 40;
/// If rounding hides the sign of a curvature, the direction is neutral where the error of the
/// curvature is at most this fraction of the curvature of the next stiffer direction.
constexpr double kFlat = 1e-3;
/// Error of a curvature, as a multiple of the energy that the residual of its direction can still
/// release.
constexpr double kErrorShare = 4.0;

/// The error bar of a sum of many small errors is so many of its standard deviations.
constexpr double kDeviations = 3.0;

/// Rounding error of a second variation [J] by that of the coordinates. They give the length of an
/// edge to their rounding, and with it its tension T, of which the second variation has T |d|^2/l
/// for a change d of the edge. A rigid rotation has no other curvature. The errors of the edges are
/// independent.
template <int Dim>
double tension_rounding(const Model& model, const Configuration& here, const Vector& direction) {
  const double coordinate =
      here.coordinates.head(model.dofs.num_positions()).lpNorm<Eigen::Infinity>();
  double squares = 0.0;
  for (const RodMesh& rod : model.rods) {
    for (Index i = 0; i < rod.num_edges(); ++i) {
      const Edge edge = rod.edge(i, model);
      const double tension = rod.EA * kEpsilon * coordinate / edge.rest_length;
      const double change = along_edge<Dim>(edge, direction).squaredNorm();
      squares += std::pow(tension * change / edge.rest_length, 2);
    }
  }
  return kDeviations * std::sqrt(squares);
}

}  // namespace

Stiffness::Stiffness(const Model& model, const Assembler& assembler, LinearSolver& solver,
                     CancelCallback beat)
    : model_(model),
      assembler_(assembler),
      solver_(solver),
      beat_(std::move(beat)),
      gradient_(Vector::Zero(model.num_dofs())),
      values_(Vector::Zero(assembler.num_values())),
      units_{model.dofs.unit_masses(), {}} {}

void Stiffness::evaluate(const Configuration& here) {
  beat();
  assembler_.gradient_and_hessian(here, gradient_, values_);
  here_ = here;
}

Inertia Stiffness::factorize(double shift, const Mass& mass) {
  beat();
  constexpr int kTrials = 5;
  double nudge = 1e-2 * rounding() / mass.lumped.cwiseQuotient(units_.lumped).maxCoeff();
  Inertia inertia;
  for (int trial = 0; trial < kTrials && !inertia.factorised; ++trial, nudge *= 10.0) {
    shifted_ = values_;
    assembler_.add_mass(mass, trial == 0 ? shift : shift + nudge, shifted_);
    inertia = solver_.factorize(shifted_);
  }
  return inertia;
}

double Stiffness::rounding() const {
  return kRoundings * kEpsilon * largest_over(model_.dofs.blocks(), [this](const DofBlock& block) {
           return assembler_.largest_diagonal(block, values_) / (block.length * block.length);
         });
}

double Stiffness::rounding_over(const Vector& mass) const {
  // Errors of what the elimination of positions brings into the entries of an angle.
  constexpr double kEliminated = 32.0;
  double largest = 0.0;
  for (const DofBlock& block : model_.dofs.blocks()) {
    const double roundings = kRoundings * (block.kind == DofKind::Position ? 1.0 : kEliminated);
    const double error = roundings * kEpsilon * assembler_.largest_diagonal(block, values_);
    for (Index dof = block.first; dof < block.first + block.count; ++dof) {
      if (model_.dofs.is_free(dof)) largest = std::max(largest, error / mass[dof]);
    }
  }
  return largest;
}

Stability Stiffness::stability() {
  const double margin = rounding();
  Stability result;
  result.unstable_directions = factorize(margin).negative_pivots;
  result.doubtful_directions =
      std::max<Index>(0, factorize(-margin).negative_pivots - result.unstable_directions);
  if (result.doubtful_directions > 0) judge_doubtful(result);
  return result;
}

bool Stiffness::is_clear() {
  const double near = kClear * rounding();
  return factorize(near).negative_pivots == factorize(-near).negative_pivots;
}

Eigen::MatrixXd Stiffness::softest_directions(Index count) {
  return softest_space(count).directions.leftCols(count);
}

void Stiffness::hold(const Eigen::MatrixXd& neutral) {
  // Pivots of the basis: the springs see each of its combinations.
  const std::vector<Index>& free = model_.dofs.free();
  const Vector lengths = units_.lumped(free).cwiseSqrt();
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(
      (lengths.asDiagonal() * neutral).transpose());
  for (const DofBlock& block : model_.dofs.blocks()) {
    const double spring = assembler_.largest_diagonal(block, values_);
    for (Eigen::Index i = 0; i < neutral.cols(); ++i) {
      const Index held = qr.colsPermutation().indices()[i];
      const Index dof = free[to_size(held)];
      if (dof < block.first || dof >= block.first + block.count) continue;
      values_[solver_.layout().slot(held, held)] += spring;
    }
  }
}

Stability Stiffness::stability_by_pivots() {
  Stability result;
  result.unstable_directions = factorize().negative_pivots;
  return result;
}

void Stiffness::judge_doubtful(Stability& stability) {
  const Index clear =
      stability.unstable_directions == 0 ? 0 : factorize(kClear * rounding()).negative_pivots;
  const Index count = stability.unstable_directions + stability.doubtful_directions - clear;
  if (count > kMostDoubtful) {
    stability.unknown_directions = stability.doubtful_directions;
    return;
  }
  const SoftSpace space = softest_space(count, clear);
  // A direction is neutral if it is flat compared with the stiffest of this space.
  const double flat = kFlat * std::abs(space.curvatures[space.curvatures.size() - 1]);
  stability.unstable_directions = clear;
  for (Index i = 0; i < count; ++i) {
    const double curvature = space.curvatures[i];
    if (curvature < -space.rounding[i]) {  // along any direction, this proves it
      ++stability.unstable_directions;
    } else if (const double error = space.rounding[i] + space.errors[i]; curvature <= error) {
      ++(error <= flat ? stability.neutral_directions : stability.unknown_directions);
    }
  }
}

double Stiffness::factorize_positive(Index but) {
  const auto positive = [&](double shift) {
    const Inertia inertia = factorize(shift);
    return inertia.factorised && inertia.negative_pivots <= but;
  };
  double high = rounding();
  double low = 0.0;
  // Without a number in the stiffness there is no rounding error to begin with.
  while (high > 0.0 && std::isfinite(high) && !positive(high)) {
    low = high;
    high *= 16.0;
  }
  if (low == 0.0) return high;
  for (int i = 0; i < 4; ++i) {
    const double middle = std::sqrt(low * high);
    (positive(middle) ? high : low) = middle;
  }
  factorize(high);
  return high;
}

SoftDirection Stiffness::softest() {
  if (factorize_positive() > rounding()) return inverse_iteration();
  return soft_direction(softest_space(1).directions.col(0));
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
    solve(next);
    next.normalize();
    const double cosine = std::abs(next.dot(x));
    x = next;
    if (1.0 - cosine < kSameDirection) break;
  }
  return soft_direction(x);
}

SoftDirection Stiffness::soft_direction(Vector free) const {
  Eigen::Index largest = 0;
  free.cwiseAbs().maxCoeff(&largest);
  if (free[largest] < 0.0) free = -free;
  const double curvature = second_variation(model_, here_, over_all_dofs(model_, free));
  return {std::move(free), curvature};
}

/// Block iteration on the residuals (Knyazev, SIAM J. Sci. Comput. 23, 2001, without its third
/// block): every step minimises the second variation over the present directions and the
/// preconditioned residuals. Second variations and residuals are summed element by element, which
/// keeps their digits.
Stiffness::SoftSpace Stiffness::softest_space(Index count, Index below) {
  constexpr int kIterations = 30;
  constexpr double kSettled = 1e-3;
  constexpr Index kSpare = 2;
  const Index size = model_.num_free();
  const Index wanted = std::min(count + kSpare, size);
  factorize_positive(below);
  Vector column = unstructured_vector(size * wanted);
  Eigen::MatrixXd basis = Eigen::Map<Eigen::MatrixXd>(column.data(), size, wanted);
  for (Index i = 0; i < wanted; ++i) {
    column = basis.col(i);
    solve(column);
    basis.col(i) = column.normalized();
  }
  SoftSpace space = rayleigh_ritz(basis, wanted, below > 0);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::MatrixXd answers(size, wanted);
    bool settled = true;
    for (Index i = 0; i < wanted; ++i) {
      const Vector& x = space.directions.col(i);
      const Vector force =
          stiffness_product(model_, here_, over_all_dofs(model_, x))(model_.dofs.free()) -
          space.curvatures[i] * x;
      column = force;
      solve(column);
      // Far below zero are terms of the other sign, which may hide as much in the energy.
      const double hidden = below == 0 ? 0.0 : 2.0 * force.squaredNorm() / (kClear * rounding());
      space.errors[i] = kErrorShare * (std::abs(force.dot(column)) + hidden);
      answers.col(i) = column.normalized();
      const double small = std::max(kSettled * std::abs(space.curvatures[i]), space.rounding[i]);
      settled = settled && (i >= count || space.errors[i] <= small);
    }
    if (settled || wanted == size || iteration + 1 == kIterations) break;
    basis.resize(size, std::min(2 * wanted, size));
    basis << space.directions, answers.leftCols(basis.cols() - wanted);
    space = rayleigh_ritz(basis, wanted, below > 0);
  }
  return space;
}

Stiffness::SoftSpace Stiffness::rayleigh_ritz(const Eigen::MatrixXd& basis, Index count,
                                              bool nearest) const {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis);
  const Eigen::MatrixXd directions =
      qr.householderQ() * Eigen::MatrixXd::Identity(basis.rows(), basis.cols());
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(model_.num_dofs(), basis.cols());
  const auto variations = [&](const Eigen::MatrixXd& free) {
    full.resize(full.rows(), free.cols());
    full.setZero();
    full(model_.dofs.free(), Eigen::all) = free;
    return second_variations(model_, here_, full);
  };
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(variations(directions).values);
  std::vector<Index> order(static_cast<std::size_t>(basis.cols()));
  std::iota(order.begin(), order.end(), Index{0});
  if (nearest) {
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
      return std::abs(solver.eigenvalues()[a]) < std::abs(solver.eigenvalues()[b]);
    });
  }
  order.resize(to_size(count));
  SoftSpace space;
  space.directions = directions * solver.eigenvectors()(Eigen::all, order);
  const SecondVariations final = variations(space.directions);
  space.curvatures = final.values.diagonal();
  space.rounding = kRoundings * kEpsilon * final.terms;
  space.rounding.array() += kEpsilon * rounding();  // of the directions' own digits
  with_dimension(model_, [&](auto dim) {
    for (Index i = 0; i < count; ++i) {
      const Vector direction = over_all_dofs(model_, space.directions.col(i));
      space.rounding[i] += tension_rounding<dim>(model_, here_, direction);
    }
  });
  space.errors = Vector::Constant(count, std::numeric_limits<double>::infinity());
  return space;
}

bool Stiffness::solve_by_elements(Vector& b) {
  constexpr int kIterations = 200;
  constexpr double kReduction = 1e-20;  // of the error's energy
  factorize_positive();
  Vector rest = b;
  Vector answer = rest;
  solve(answer);
  Vector direction = answer;
  double energy = rest.dot(answer);
  const double first = energy;
  b.setZero();
  for (int i = 0; i < kIterations; ++i) {
    if (energy <= kReduction * first) return b.allFinite();
    const Vector full = over_all_dofs(model_, direction);
    const double curvature = second_variation(model_, here_, full);
    if (!(curvature > 0.0)) return false;
    const double step = energy / curvature;
    b += step * direction;
    rest -= step * stiffness_product(model_, here_, full)(model_.dofs.free());
    answer = rest;
    solve(answer);
    const double before = std::exchange(energy, rest.dot(answer));
    direction = answer + energy / before * direction;
  }
  return false;
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
