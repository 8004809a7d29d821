// Gradient and Hessian of every energy in the registry against finite differences, and the
// invariance under rigid motion that every elastic energy must have.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

constexpr int kSamples = 200;

/// Sixth-order central difference of f at 0 [weights: Fornberg, Math. Comp. 51, 1988, table 1].
/// With a step of 5e-3 times the distance to the nearest singularity its error is about 1e-11 of f.
template <class F>
auto derivative(F&& f, double h) {
  using Result = decltype(f(0.0));
  const Result d1 = f(h) - f(-h);
  const Result d2 = f(2 * h) - f(-2 * h);
  const Result d3 = f(3 * h) - f(-3 * h);
  return Result((45.0 * d1 - 9.0 * d2 + d3) / (60.0 * h));
}

template <class Kernel>
void check_derivatives(Shape shape, Random& random) {
  constexpr int n = Kernel::kDofs;
  using Coordinates = Eigen::Matrix<double, n, 1>;
  auto constants = sample_constants(Kernel{}, random);
  Configuration here = sample_configuration(random);
  const Coordinates x = sample_positions<Kernel>(shape, random);
  sample_frames(Kernel{}, constants, x, random, here);

  const auto energy = [&](const Coordinates& y) {
    LocalTerm<n> term;
    evaluate_element<Kernel, Derivatives::Energy>(constants, here, y, term);
    return term.energy;
  };
  const auto gradient = [&](const Coordinates& y) {
    LocalTerm<n> term;
    evaluate_element<Kernel, Derivatives::Gradient>(constants, here, y, term);
    return term.gradient;
  };
  LocalTerm<n> exact;
  evaluate_element<Kernel, Derivatives::Hessian>(constants, here, x, exact);
  CHECK(exact.energy == energy(x));
  CHECK(exact.gradient == gradient(x));

  // The fold is 0.05 rad away at the least, and the shortest edge 0.15 long.
  const double h = shape == Shape::NearFolded || shape == Shape::Stretched ? 4e-4 : 2e-3;
  const double energy_scale = std::abs(exact.energy) + 1.0;
  double largest_entry = 0.0;
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i)
      largest_entry = std::max(largest_entry, std::abs(exact.hessian(i, j)));
  }
  for (int j = 0; j < n; ++j) {
    const auto along = [&](double t) {
      Coordinates y = x;
      y[j] += t;
      return y;
    };
    const double slope = derivative([&](double t) { return energy(along(t)); }, h);
    CHECK(std::abs(slope - exact.gradient[j]) < 1e-7 * (energy_scale + largest_entry));
    const Coordinates column = derivative([&](double t) { return gradient(along(t)); }, h);
    for (int i = j; i < n; ++i) {
      CHECK(std::abs(column[i] - exact.hessian(i, j)) < 1e-6 * (1.0 + largest_entry));
    }
  }
}

template <class Kernel>
void check_rigid_motion(Shape shape, Random& random) {
  constexpr int n = Kernel::kDofs;
  const auto constants = sample_constants(Kernel{}, random);
  const Configuration here = sample_configuration(random);
  const auto x = sample_positions<Kernel>(shape, random);
  LocalTerm<n> before;
  evaluate_element<Kernel, Derivatives::Gradient>(constants, here, x, before);

  // No net force, and no net moment about the origin.
  Vec2 force = Vec2::Zero();
  double moment = 0.0;
  for (int node = 0; node < n / 2; ++node) {
    const Vec2 f = before.gradient.template segment<2>(2 * node);
    force += f;
    moment += cross(x.template segment<2>(2 * node), f);
  }
  const double scale = 1.0 + before.gradient.template lpNorm<Eigen::Infinity>();
  CHECK(force.norm() < 1e-13 * scale);
  CHECK(std::abs(moment) < 1e-12 * scale);

  const double angle = uniform(random, -3.0, 3.0);
  const Eigen::Rotation2Dd rotation(angle);
  auto moved = x;
  for (int node = 0; node < n / 2; ++node) {
    moved.template segment<2>(2 * node) =
        rotation * x.template segment<2>(2 * node) + Vec2{0.3, -0.7};
  }
  LocalTerm<n> after;
  evaluate_element<Kernel, Derivatives::Energy>(constants, here, moved, after);
  CHECK(after.energy == doctest::Approx(before.energy).epsilon(1e-11));
}

template <class F>
void for_each_shape(F&& f) {
  Random random(20261121);
  for (const Shape shape : kShapes) {
    for (int i = 0; i < kSamples; ++i) f(shape, random);
  }
}

}  // namespace

TEST_CASE("gradient and Hessian of every element agree with finite differences") {
  for_each_list(ElementLists{}, [](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    for_each_shape(check_derivatives<Kernel>);
  });
}

TEST_CASE("rigid motions cost no energy and make no force") {
  for_each_shape(check_rigid_motion<Stretch<2>>);
  for_each_shape(check_rigid_motion<AxialSpring<2>>);
  for_each_shape(check_rigid_motion<PlanarBend<AngleCurvature>>);
  for_each_shape(check_rigid_motion<PlanarBend<TangentCurvature>>);
}

}  // namespace der::test
