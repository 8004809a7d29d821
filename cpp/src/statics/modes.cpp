#include "der/statics/modes.hpp"

#include <Spectra/SymGEigsShiftSolver.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "der/core/constants.hpp"
#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/statics/equilibrium_failure.hpp"
#include "der/statics/potential.hpp"
#include "der/statics/stiffness.hpp"

namespace der {
namespace {

/// Up to this many degrees of freedom the inverse is formed: Lanczos' method needs room.
constexpr Index kSmall = 24;

/// |shift| (K - shift M)^-1 as Spectra wants it, by the linear solver, with the shapes that are
/// known already left out of the result. With that factor its eigenvalues of interest are of order
/// 1 for rods of any size: Spectra takes what is below 4e-11 for zero.
class ShiftInvert {
 public:
  using Scalar = double;
  ShiftInvert(Stiffness& stiffness, const Model& model, const Eigen::MatrixXd& known,
              const Eigen::MatrixXd& momenta)
      : stiffness_(stiffness),
        mass_(model.mass),
        size_(model.num_free()),
        known_(known),
        momenta_(momenta) {}

  [[nodiscard]] Eigen::Index rows() const { return size_; }
  [[nodiscard]] Eigen::Index cols() const { return size_; }
  void set_shift(const double& shift) {
    scale_ = std::abs(shift);
    stiffness_.factorize(-shift, mass_);
  }
  void perform_op(const double* in, double* out) const {
    work_ = Eigen::Map<const Vector>(in, size_);
    stiffness_.solve(work_);
    if (known_.cols() > 0) work_ -= known_ * (momenta_.transpose() * work_);
    Eigen::Map<Vector>(out, size_) = scale_ * work_;
  }

 private:
  Stiffness& stiffness_;
  const Mass& mass_;
  Index size_;
  double scale_ = 1.0;
  const Eigen::MatrixXd& known_;    // one a column, of modal mass 1
  const Eigen::MatrixXd& momenta_;  // M times those
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
    full_(model_.dofs.free()) = Eigen::Map<const Vector>(in, rows());
    Eigen::Map<Vector>(out, rows()) = model_.mass.momentum(full_)(model_.dofs.free());
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

/// Free degrees of freedom that have mass: all but the rotations of joints, which follow them.
std::vector<Index> with_mass(const Model& model) {
  std::vector<Index> places;
  for (Index i = 0; i < model.num_free(); ++i) {
    if (model.dofs.free()[to_size(i)] < model.dofs.rotation(0)) places.push_back(i);
  }
  return places;
}

/// Modes of a small model: with M = L L^T over what has mass, the eigenvectors of
/// L^T (K - shift M)^-1 L are L^T v. Another product with (K - shift M)^-1 M gives the rest of v.
Eigen::MatrixXd dense_vectors(const ShiftInvert& inverse, const MassProduct& mass, Index count,
                              const std::vector<Index>& with_mass) {
  const Eigen::MatrixXd all = dense(mass);
  const Eigen::MatrixXd answers = dense(inverse);
  const Eigen::LLT<Eigen::MatrixXd> factor(all(with_mass, with_mass));
  const Eigen::MatrixXd L = factor.matrixL();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(L.transpose() *
                                                              answers(with_mass, with_mass) * L);
  const Eigen::MatrixXd scaled = solver.eigenvectors().rowwise().reverse().leftCols(count);
  const Eigen::MatrixXd shapes = factor.matrixU().solve(scaled);
  return answers * (all(Eigen::all, with_mass) * shapes);
}

/// A shape v of modal mass 1 with the square of its angular frequency, v' K v.
struct Shape {
  double square = 0.0;  ///< [1/s^2]
  double terms = 0.0;   ///< what was summed to get it, by size
  Vector vector;        ///< all degrees of freedom
};

/// The effect of rounding in the matrix K on the squares w^2 of K v = w^2 M v.
struct Noise {
  /// [1/s^2] It shifts them by up to this, and mixes shapes whose squares are not further apart.
  double square = 0.0;
  Index below = 0;      ///< number of squares below -square: unstable directions
  Index near_zero = 0;  ///< number of those between -square and square
  /// [1/s^2] The error in the square of a shape near zero from the shapes that are not near zero.
  /// These enter with the ratio of the noise to their own square, and through the sum of many
  /// rounding errors, not through the largest.
  double left = 0.0;
};

Noise matrix_noise(Stiffness& stiffness, const Model& model) {
  Noise noise;
  const auto can_vibrate = static_cast<Index>(with_mass(model).size());
  Vector mass = model.mass.lower_bound();
  mass.tail(model.dofs.num_rotations()).setConstant(std::numeric_limits<double>::infinity());
  noise.square = stiffness.rounding_over(mass);
  const auto below = [&](double square) {
    return stiffness.factorize(-square, model.mass).negative_pivots;
  };
  noise.below = below(-noise.square);
  noise.near_zero = std::max<Index>(0, below(noise.square) - noise.below);
  double next = noise.square;
  while (below(4.0 * next) == noise.below + noise.near_zero &&
         noise.below + noise.near_zero < can_vibrate) {
    next *= 4.0;
  }
  const double typical = noise.square / (8.0 * std::sqrt(model.num_free()));
  noise.left = typical * typical / next;
  return noise;
}

/// A shift below all squares w^2, near enough to the `count` lowest ones for their digits.
double shift_below(Stiffness& stiffness, const Model& model, Index count, double least) {
  double below = least;
  while (stiffness.factorize(below, model.mass).negative_pivots > 0) below *= 4.0;
  double highest = least;
  while (stiffness.factorize(-highest, model.mass).negative_pivots < count) highest *= 4.0;
  return -std::max(below, 0.01 * highest);
}

void check_masses(const Model& model) {
  const Vector masses = model.mass.lumped(model.dofs.free());
  if (masses(with_mass(model)).minCoeff() > 0.0) return;
  throw Error("model_error",
              "a node without mass has no vibration: give the rod a density, or spheres");
}

/// Squares that are zero to rounding are those of motions that nothing resists. Where there are
/// fewer of these, rounding has hidden vibrations.
void check_resolved(Index zeros, Stiffness& stiffness) {
  if (zeros == 0 || zeros <= stiffness.stability().neutral_directions) return;
  throw NotConvergedError(
      "the lowest frequencies are lost in the rounding errors of the stiffness of the shortest "
      "edges: give the rods fewer nodes, longer edges, or a smaller EA",
      status_of(EquilibriumFailure::LostInRoundoff));
}

Vector over_all(const Model& model, const Vector& free) {
  Vector full = Vector::Zero(model.num_dofs());
  full(model.dofs.free()) = free;
  return full;
}

/// The shapes of lowest square w^2, found in as many passes as it takes until none is missing.
class ModeSearch {
 public:
  ModeSearch(const Model& model, Stiffness& stiffness, const Configuration& here)
      : model_(model),
        stiffness_(stiffness),
        here_(here),
        with_mass_(with_mass(model)),
        known_(model.num_free(), 0),
        momenta_(model.num_free(), 0) {}

  /// The `count` lowest or more, by ascending square.
  std::vector<Shape> lowest(Index count, const Noise& noise) {
    constexpr int kPasses = 50;
    const double shift = shift_below(stiffness_, model_, count, noise.square);
    Index missing = count;
    for (int pass = 0; pass < kPasses && missing > 0; ++pass) {
      add(pass_vectors(missing, shift, pass));
      missing = std::max(count - static_cast<Index>(shapes_.size()),
                         missing_below_highest(count, shift, noise));
    }
    if (missing > 0) {
      throw NotConvergedError(
          fmt::format("{} of the {} lowest vibration modes cannot be found; ask for fewer, or for "
                      "more",
                      missing, count));
    }
    unmix(noise);
    return std::move(shapes_);
  }

 private:
  /// Lanczos' method finds one shape of a repeated square, and others only through rounding.
  Eigen::MatrixXd pass_vectors(Index count, double shift, int pass) {
    constexpr int kRestarts = 1000;
    constexpr double kTolerance = 1e-12;
    const Index size = model_.num_free();
    ShiftInvert inverse(stiffness_, model_, known_, momenta_);
    MassProduct mass(model_);
    const auto can_vibrate = static_cast<Index>(with_mass_.size());
    if (pass == 0 && (size <= kSmall || 2 * count >= can_vibrate)) {
      inverse.set_shift(shift);
      return dense_vectors(inverse, mass, count, with_mass_);
    }
    const Index wanted = std::min(count, can_vibrate - 1);
    const Index basis = std::min(can_vibrate, std::max<Index>(2 * wanted + 1, 20));
    Spectra::SymGEigsShiftSolver<ShiftInvert, MassProduct, Spectra::GEigsMode::ShiftInvert> solver(
        inverse, mass, wanted, basis, shift);
    // Each pass has another start vector, which contains only one shape of a repeated square.
    Vector start = unstructured_vector((pass + 1) * size).tail(size);
    if (can_vibrate < size) {
      // Rotations of joints, which have no mass, stay as they begin.
      inverse.set_shift(shift);
      Vector momentum(size);
      mass.perform_op(start.data(), momentum.data());
      inverse.perform_op(momentum.data(), start.data());
    }
    solver.init(start.data());
    solver.compute(Spectra::SortRule::LargestMagn, kRestarts, kTolerance,
                   Spectra::SortRule::SmallestAlge);
    if (solver.info() != Spectra::CompInfo::Successful) {
      throw NotConvergedError("the vibration modes did not converge; ask for fewer, or for more");
    }
    return solver.eigenvectors();
  }

  void add(const Eigen::MatrixXd& vectors) {
    const MassProduct mass(model_);
    const Eigen::Index old = known_.cols();
    known_.conservativeResize(Eigen::NoChange, old + vectors.cols());
    momenta_.conservativeResize(Eigen::NoChange, old + vectors.cols());
    for (Eigen::Index i = 0; i < vectors.cols(); ++i) {
      const Shape& added = shapes_.emplace_back(measured(over_all(model_, vectors.col(i))));
      known_.col(old + i) = added.vector(model_.dofs.free());
      mass.perform_op(known_.col(old + i).data(), momenta_.col(old + i).data());
    }
    sort();
  }

  /// Number of shapes that are missing among the `count` lowest, by the inertia.
  Index missing_below_highest(Index count, double shift, const Noise& noise) {
    constexpr double kSame = 1e-9;
    const auto last = std::min(shapes_.size(), to_size(count)) - 1;
    const double highest = shapes_[last].square;
    const double cut = highest - kSame * (highest - shift) - noise.square;
    const auto found = std::count_if(shapes_.begin(), shapes_.end(),
                                     [cut](const Shape& s) { return s.square < cut; });
    const Index there = stiffness_.factorize(-cut, model_.mass).negative_pivots;
    return std::min(there, count) - static_cast<Index>(found);
  }

  /// The matrix gives arbitrary mixtures of shapes whose squares are near zero, such as rigid
  /// motions and a bar on a soft spring. The energies of the elements are accurate enough to
  /// separate them.
  void unmix(const Noise& noise) {
    const auto size = static_cast<Eigen::Index>(noise.near_zero);
    if (size < 2) return;
    const auto at_zero = [&](Eigen::Index i) -> Shape& {
      return shapes_[to_size(noise.below) + static_cast<std::size_t>(i)];
    };
    const auto energy = [&](const Vector& v) { return second_variation(model_, here_, v); };
    Eigen::MatrixXd stiffness(size, size);
    Eigen::MatrixXd vectors(model_.num_dofs(), size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const Vector& v = at_zero(i).vector;
      vectors.col(i) = v;
      stiffness(i, i) = at_zero(i).square;
      for (Eigen::Index j = 0; j < i; ++j) {
        const Vector& w = at_zero(j).vector;
        stiffness(i, j) = 0.25 * (energy(v + w) - energy(v - w));
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness);  // lower triangle
    for (Eigen::Index i = 0; i < size; ++i) {
      at_zero(i) = measured(vectors * solver.eigenvectors().col(i));
    }
    sort();
  }

  /// A shape scaled to modal mass 1, its largest component positive.
  [[nodiscard]] Shape measured(Vector v) const {
    Eigen::Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    v *= std::copysign(1.0, v[largest]) / std::sqrt(2.0 * model_.mass.kinetic_energy(v));
    // Taken element by element, which keeps the digits of soft modes of stiff rods.
    const SummedVariation sum = summed_variation(model_, here_, v);
    return {sum.value, sum.terms, std::move(v)};
  }

  void sort() {
    std::sort(shapes_.begin(), shapes_.end(),
              [](const Shape& a, const Shape& b) { return a.square < b.square; });
  }

  const Model& model_;
  Stiffness& stiffness_;
  const Configuration& here_;
  std::vector<Index> with_mass_;
  std::vector<Shape> shapes_;  // by ascending square
  Eigen::MatrixXd known_;      // the same over the free degrees of freedom, as they were found
  Eigen::MatrixXd momenta_;    // M times those
};

}  // namespace

std::vector<Mode> vibration_modes(const Model& model, const Assembler& assembler,
                                  LinearSolver& solver, const Configuration& here, int count,
                                  const CancelCallback& beat) {
  check_masses(model);
  const Index wanted = std::min<Index>(count, static_cast<Index>(with_mass(model).size()));
  Stiffness stiffness(model, assembler, solver, beat);
  stiffness.evaluate(here);
  const Noise noise = matrix_noise(stiffness, model);
  auto shapes = ModeSearch(model, stiffness, here)
                    .lowest(std::max(wanted, noise.below + noise.near_zero), noise);
  shapes.resize(to_size(wanted));

  const auto free_to_move = [&noise](const Shape& shape) {
    constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
    return std::abs(shape.square) <= kRounding * shape.terms + noise.left;
  };
  const auto zeros = std::count_if(shapes.begin(), shapes.end(), free_to_move);
  check_resolved(static_cast<Index>(zeros), stiffness);

  std::vector<Mode> modes;
  for (Shape& shape : shapes) {
    const double rate = free_to_move(shape) ? 0.0 : std::sqrt(std::abs(shape.square));
    const bool grows = shape.square < 0.0;
    modes.push_back(
        {grows ? 0.0 : rate / (2.0 * kPi), grows ? rate : 0.0, std::move(shape.vector)});
  }
  return modes;
}

}  // namespace der
