#include "der/statics/modes.hpp"

#include <Spectra/SymGEigsShiftSolver.h>
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

/// (K - shift M)^-1 as Spectra wants it, by the linear solver.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(Stiffness& stiffness, const Model& model)
      : stiffness_(stiffness), mass_(model.mass), size_(model.num_free()) {}

  [[nodiscard]] Eigen::Index rows() const { return size_; }
  [[nodiscard]] Eigen::Index cols() const { return size_; }
  void set_shift(const double& shift) { stiffness_.factorize(-shift, mass_); }
  void perform_op(const double* in, double* out) const {
    work_ = Eigen::Map<const Vector>(in, size_);
    stiffness_.solve(work_);
    Eigen::Map<Vector>(out, size_) = work_;
  }

 private:
  Stiffness& stiffness_;
  const Mass& mass_;
  Index size_;
  mutable Vector work_;
};

/// M over the free degrees of freedom, as Spectra wants it.
class MassProduct {
 public:
  using Scalar = double;
  explicit MassProduct(const Model& model) : model_(model), full_(Vector::Zero(model.num_dofs())) {}

  [[nodiscard]] Eigen::Index rows() const { return model_.num_free(); }
  [[nodiscard]] Eigen::Index cols() const { return model_.num_free(); }
  void perform_op(const double* in, double* out) const {
    full_(model_.free_dofs) = Eigen::Map<const Vector>(in, rows());
    Eigen::Map<Vector>(out, rows()) = model_.mass.momentum(full_)(model_.free_dofs);
  }

 private:
  const Model& model_;
  mutable Vector full_;  // held degrees of freedom stay 0
};

template <class Operation>
Eigen::MatrixXd dense(const Operation& operation) {
  const Eigen::Index size = operation.rows();
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    const Vector unit = Vector::Unit(size, j);
    operation.perform_op(unit.data(), matrix.col(j).data());
  }
  return 0.5 * (matrix + matrix.transpose());
}

/// Of a small model: with M = L L^T, the eigenvectors of L^T (K - shift M)^-1 L are L^T v.
Eigen::MatrixXd dense_vectors(const ShiftInvert& inverse, const MassProduct& mass, Index count) {
  const Eigen::LLT<Eigen::MatrixXd> factor(dense(mass));
  const Eigen::MatrixXd L = factor.matrixL();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(L.transpose() * dense(inverse) * L);
  const Eigen::MatrixXd scaled = solver.eigenvectors().rowwise().reverse().leftCols(count);
  return factor.matrixU().solve(scaled);
}

/// Eigenvectors of K v = w^2 M v, one a column, of the `count` eigenvalues nearest above `shift`.
Eigen::MatrixXd lowest_vectors(ShiftInvert& inverse, MassProduct& mass, Index count, double shift) {
  const Index size = static_cast<Index>(inverse.rows());
  if (size <= kSmall) {
    inverse.set_shift(shift);
    return dense_vectors(inverse, mass, count);
  }
  constexpr int kRestarts = 1000;
  constexpr double kTolerance = 1e-12;
  const Index basis = std::min(size, std::max<Index>(2 * count + 1, 20));
  Spectra::SymGEigsShiftSolver<ShiftInvert, MassProduct, Spectra::GEigsMode::ShiftInvert> solver(
      inverse, mass, count, basis, shift);
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
  const double least = stiffness.rounding() / model.mass.lower_bound()(model.free_dofs).minCoeff();
  double below = least;
  while (stiffness.factorize(below, model.mass).negative_pivots > 0) below *= 4.0;
  highest = least;
  while (stiffness.factorize(-highest, model.mass).negative_pivots < count) highest *= 4.0;
  return -std::max(below, 0.01 * highest);
}

void check_masses(const Model& model) {
  if (model.mass.lumped(model.free_dofs).minCoeff() > 0.0) return;
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
  ShiftInvert inverse(stiffness, model);
  MassProduct mass(model);
  const Index computed =
      model.num_free() <= kSmall ? wanted : std::min(wanted, model.num_free() - 1);
  const Eigen::MatrixXd vectors = lowest_vectors(inverse, mass, computed, shift);

  std::vector<std::pair<double, Vector>> pairs;  // square of the angular frequency, shape
  for (Index i = 0; i < vectors.cols(); ++i) {
    Vector shape = over_all(model, vectors.col(i));
    shape /= std::sqrt(2.0 * model.mass.kinetic_energy(shape));  // v^T M v = 1
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
