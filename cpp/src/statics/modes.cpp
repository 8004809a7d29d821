#include "der/statics/modes.hpp"

#include <Spectra/SymEigsShiftSolver.h>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/constants.hpp"
#include "der/core/error.hpp"
#include "der/statics/potential.hpp"
#include "der/statics/stiffness.hpp"

namespace der {
namespace {

/// Up to this many degrees of freedom the inverse is formed: Lanczos' method needs room.
constexpr Index kSmall = 24;

/// (M^-1/2 K M^-1/2 - shift I)^-1 as Spectra wants it, by the linear solver.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(Stiffness& stiffness, const Model& model)
      : stiffness_(stiffness), mass_(model.mass), root_(model.mass(model.free_dofs).cwiseSqrt()) {}

  [[nodiscard]] Eigen::Index rows() const { return root_.size(); }
  [[nodiscard]] Eigen::Index cols() const { return root_.size(); }
  void set_shift(const double& shift) { stiffness_.factorize(-shift, mass_); }
  void perform_op(const double* in, double* out) const {
    work_ = Eigen::Map<const Vector>(in, rows()).cwiseProduct(root_);
    stiffness_.solve(work_);
    Eigen::Map<Vector>(out, rows()) = work_.cwiseProduct(root_);
  }
  /// Displacements from a vector of the symmetric problem.
  [[nodiscard]] Vector displacement(const Vector& scaled) const {
    return scaled.cwiseQuotient(root_);
  }

 private:
  Stiffness& stiffness_;
  const Vector& mass_;
  Vector root_;
  mutable Vector work_;
};

/// Eigenvectors, one a column, of the `count` eigenvalues nearest above `shift`.
Eigen::MatrixXd lowest_vectors(ShiftInvert& operation, Index count, double shift) {
  const Index size = static_cast<Index>(operation.rows());
  if (size <= kSmall) {
    operation.set_shift(shift);
    Eigen::MatrixXd inverse(size, size);
    for (Index j = 0; j < size; ++j) {
      const Vector unit = Vector::Unit(size, j);
      operation.perform_op(unit.data(), inverse.col(j).data());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 *
                                                                (inverse + inverse.transpose()));
    return solver.eigenvectors().rowwise().reverse().leftCols(count);
  }
  constexpr int kRestarts = 1000;
  constexpr double kTolerance = 1e-12;
  const Index basis = std::min(size, std::max<Index>(2 * count + 1, 20));
  Spectra::SymEigsShiftSolver<ShiftInvert> solver(operation, count, basis, shift);
  const Vector start = unstructured_vector(size);
  solver.init(start.data());
  solver.compute(Spectra::SortRule::LargestMagn, kRestarts, kTolerance,
                 Spectra::SortRule::SmallestAlge);
  if (solver.info() != Spectra::CompInfo::Successful) {
    throw NotConvergedError("the vibration modes did not converge; ask for fewer, or for more");
  }
  return solver.eigenvectors();
}

/// A shift below all eigenvalues w^2 of K v = w^2 M v, near enough to the lowest ones for their
/// digits; `highest` is set to about the highest of the `count` lowest ones.
double shift_below(Stiffness& stiffness, const Model& model, Index count, double& highest) {
  const double least = stiffness.rounding() / model.mass(model.free_dofs).minCoeff();
  double below = least;
  while (stiffness.factorize(below, model.mass).negative_pivots > 0) below *= 4.0;
  highest = least;
  while (stiffness.factorize(-highest, model.mass).negative_pivots < count) highest *= 4.0;
  return -std::max(below, 0.01 * highest);
}

void check_masses(const Model& model) {
  const Vector mass = model.mass(model.free_dofs);
  if (mass.minCoeff() > 0.0) return;
  throw Error("model_error",
              "a node without mass has no vibration: give the rod a density, or spheres");
}

Vector over_all(const Model& model, const Vector& free) {
  Vector full = Vector::Zero(model.num_dofs());
  full(model.free_dofs) = free;
  return full;
}

/// The largest component becomes positive.
void fix_sign(Vector& shape) {
  Eigen::Index largest = 0;
  shape.cwiseAbs().maxCoeff(&largest);
  if (shape[largest] < 0.0) shape = -shape;
}

}  // namespace

std::vector<Mode> vibration_modes(const Model& model, const Assembler& assembler,
                                  LinearSolver& solver, const Vector& positions,
                                  const Vector& controls, int count) {
  /// Squares of frequencies below this share of the highest are those of rigid motions.
  constexpr double kRigid = 1e-10;
  check_masses(model);
  const Index wanted = std::min<Index>(count, model.num_free());
  Stiffness stiffness(model, assembler, solver);
  stiffness.evaluate(positions, controls);
  double highest = 0.0;
  const double shift = shift_below(stiffness, model, wanted, highest);
  ShiftInvert operation(stiffness, model);
  const Index computed =
      model.num_free() <= kSmall ? wanted : std::min(wanted, model.num_free() - 1);
  const Eigen::MatrixXd vectors = lowest_vectors(operation, computed, shift);

  std::vector<std::pair<double, Vector>> pairs;  // square of the angular frequency, shape
  for (Index i = 0; i < vectors.cols(); ++i) {
    Vector shape = over_all(model, operation.displacement(vectors.col(i)));
    shape /= std::sqrt(shape.dot(model.mass.cwiseProduct(shape)));
    fix_sign(shape);
    // Taken element by element, which keeps the digits of soft modes of stiff rods.
    const double square = second_variation(model, controls, positions, shape);
    pairs.emplace_back(square, std::move(shape));
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Mode> modes;
  for (auto& [square, shape] : pairs) {
    const double rate = std::abs(square) <= kRigid * highest ? 0.0 : std::sqrt(std::abs(square));
    modes.push_back(
        {square > 0.0 ? rate / (2.0 * kPi) : 0.0, square < 0.0 ? rate : 0.0, std::move(shape)});
  }
  return modes;
}

}  // namespace der
