// The discrete gradient of every energy in the registry: what defines it (Gonzalez, J. Nonlinear
// Sci. 6, 1996, section 3), what keeps the momenta, and where its quotients would lose digits.
#include "der/energies/discrete_gradient.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <type_traits>

#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

constexpr int kSamples = 200;

template <class Kernel>
struct FollowsTurns : std::false_type {};
template <int Edges>
struct FollowsTurns<RotationalSpring<Edges>> : std::true_type {};
template <class Kernel>
struct FollowsTurns<FromPivot<Kernel>> : FollowsTurns<Kernel> {};

/// The constants and the coordinates of the kernel itself, which may start from a clamp's pivot.
template <class Kernel>
struct Plain {
  static const auto& constants(const typename Kernel::Constants& c) { return c; }
  template <class Coordinates>
  static Coordinates seen(const typename Kernel::Constants& /*c*/, const Configuration& /*here*/,
                          const Coordinates& x) {
    return x;
  }
};
template <class Kernel>
struct Plain<FromPivot<Kernel>> {
  using Constants = typename FromPivot<Kernel>::Constants;
  static const auto& constants(const Constants& c) { return c.element; }
  template <class Coordinates>
  static Coordinates seen(const Constants& c, const Configuration& here, const Coordinates& x) {
    return FromPivot<Kernel>::from_pivots(c, here.controls, x);
  }
};

/// One element with its controls, and what is asked of it.
template <class Kernel>
struct Element {
  static constexpr int n = Kernel::kDofs;
  using Coordinates = Eigen::Matrix<double, n, 1>;

  explicit Element(Random& random)
      : constants(sample_constants(Kernel{}, random)), here(sample_configuration(random)) {}

  [[nodiscard]] double energy(const Coordinates& x) const {
    LocalTerm<n> term;
    evaluate_element<Kernel, Derivatives::Energy>(constants, here, x, term);
    return term.energy;
  }
  [[nodiscard]] Coordinates gradient(const Coordinates& x) const {
    LocalTerm<n> term;
    evaluate_element<Kernel, Derivatives::Gradient>(constants, here, x, term);
    return term.gradient;
  }
  [[nodiscard]] Coordinates discrete(const Coordinates& start, const Coordinates& end) const {
    Coordinates result;
    discrete_gradient(KernelTag<Kernel>{}, constants, here, start, end, result);
    return result;
  }
  /// Change of energy from `start` to `end` less the discrete gradient along it, and the rounding
  /// error to expect of it.
  [[nodiscard]] double gap(const Coordinates& start, const Coordinates& end) const {
    const Coordinates d = discrete(start, end);
    double gap = followed(start, end).energy(end) - energy(start) - d.dot(end - start);
    if constexpr (std::is_same_v<Kernel, PlanarMoment>) {
      gap = std::remainder(gap, PlanarMoment::period(constants, here));
    } else if constexpr (std::is_same_v<Kernel, FromPivot<PlanarMoment>>) {
      gap = std::remainder(gap, PlanarMoment::period(constants.element, here));
    }
    const double scale = 1.0 + std::abs(energy(start)) + std::abs(energy(end)) +
                         d.norm() * (start.norm() + end.norm());
    return std::abs(gap) / scale;
  }

  /// The element at the end of a step: one that follows the turns of its first edge knows them.
  [[nodiscard]] Element followed(const Coordinates& start, const Coordinates& end) const {
    Element element = *this;
    if constexpr (FollowsTurns<Kernel>::value) {
      const auto edge = [&](const Coordinates& x) -> Vec2 {
        const Coordinates ends = Plain<Kernel>::seen(constants, here, x);
        return ends.template segment<2>(2) - ends.template head<2>();
      };
      const auto& spring = Plain<Kernel>::constants(constants);
      double& turn = element.here.controls[spring.turn];
      const double then = spring.direction + turn;
      turn += angle_between({std::cos(then), std::sin(then)}, edge(start)) +
              angle_between(edge(start), edge(end));
    }
    return element;
  }

  typename Kernel::Constants constants;
  Configuration here;
};

/// Nodes turned together about the origin and moved.
template <int N>
Eigen::Matrix<double, N, 1> moved(const Eigen::Matrix<double, N, 1>& x, double angle) {
  Eigen::Matrix<double, N, 1> result;
  const Eigen::Rotation2Dd rotation(angle);
  for (int node = 0; node < N / 2; ++node) {
    result.template segment<2>(2 * node) =
        rotation * x.template segment<2>(2 * node) + Vec2{0.3, -0.7};
  }
  return result;
}

template <class Kernel, class F>
void for_each_sample(F&& f) {
  Random random(20261122);
  for (const Shape shape : kShapes) {
    for (int i = 0; i < kSamples; ++i) f(Element<Kernel>(random), shape, random);
  }
}

/// Calls f(kernel) for each kernel that `energy_momentum` takes: it is for planar rods without
/// joints alone.
template <class F>
void for_each_kernel(F&& f) {
  for_each_list(ElementLists{}, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (!IsSpatial<Kernel>::value && !HasRotations<Kernel>::value) f(Kernel{});
  });
}

template <class Kernel>
void check_momenta() {
  constexpr int n = Kernel::kDofs;
  for_each_sample<Kernel>([](const auto& element, Shape shape, Random& random) {
    const auto start = sample_positions<Kernel>(shape, random);
    const auto end = sample_positions<Kernel>(shape, random);
    const auto d = element.discrete(start, end);
    Vec2 force = Vec2::Zero();
    double moment = 0.0;
    for (int node = 0; node < n / 2; ++node) {
      const Vec2 f = d.template segment<2>(2 * node);
      const Vec2 middle = 0.5 * (start + end).template segment<2>(2 * node);
      force += f;
      moment += cross(middle, f);
    }
    const double scale = 1.0 + d.template lpNorm<Eigen::Infinity>();
    CHECK(force.norm() < 1e-13 * scale);
    CHECK(std::abs(moment) < 1e-12 * scale);
    // A rigid motion, however large, takes no force from an element at rest.
    const auto turned = moved<n>(start, uniform(random, -3.0, 3.0));
    CHECK(std::abs(element.discrete(start, turned).dot(turned - start)) <
          1e-12 * (1.0 + std::abs(element.energy(start)) + scale));
  });
}

}  // namespace

TEST_CASE("a discrete gradient along a step is the change of energy, however large the step") {
  for_each_kernel([](auto kernel) {
    using Kernel = decltype(kernel);
    for_each_sample<Kernel>([](const auto& element, Shape shape, Random& random) {
      const auto start = sample_positions<Kernel>(shape, random);
      CHECK(element.gap(start, sample_positions<Kernel>(shape, random)) < 1e-13);
      // Small steps: quotients of small differences.
      for (const double size : {1e-2, 1e-5, 1e-8, 1e-11}) {
        const typename Element<Kernel>::Coordinates step =
            size * Element<Kernel>::Coordinates::Random();
        CHECK(element.gap(start, start + step) < 1e-13);
      }
    });
  });
}

TEST_CASE("a discrete gradient is that of the middle to second order") {
  for_each_kernel([](auto kernel) {
    using Kernel = decltype(kernel);
    using Coordinates = typename Element<Kernel>::Coordinates;
    Random random(7);
    for (int i = 0; i < kSamples; ++i) {
      const Element<Kernel> element(random);
      const Coordinates x = sample_positions<Kernel>(Shape::NearStraight, random);
      Coordinates step;
      for (int k = 0; k < Kernel::kDofs; ++k) step[k] = uniform(random, -1.0, 1.0);
      const auto off = [&](double h) {
        return (element.discrete(x - h * step, x + h * step) - element.gradient(x)).norm();
      };
      const double scale = 1.0 + element.gradient(x).norm();
      CHECK(off(0.0) < 1e-13 * scale);
      if (off(2e-2) < 1e-9 * scale) continue;  // quadratic energies: exact
      CHECK(std::log2(off(2e-2) / off(1e-2)) == doctest::Approx(2.0).epsilon(0.05));
      // No rounding error that grows as the step gets short.
      CHECK(off(1e-9) < 1e-12 * scale);
      CHECK(off(1e-15) < 1e-12 * scale);
    }
  });
}

TEST_CASE("a discrete gradient goes through a fold, where the turning angle jumps by a turn") {
  Random random(3);
  for (int i = 0; i < kSamples; ++i) {
    const auto at_angle = [&](double angle) {
      Eigen::Matrix<double, 6, 1> x;
      x << 0.0, 0.0, 1.0, 0.0, 1.0 + std::cos(angle), std::sin(angle);
      return x;
    };
    const double before = kPi - uniform(random, 0.01, 0.3);
    const double after = kPi + uniform(random, 0.01, 0.3);
    const Element<PlanarBend<AngleCurvature>> angle(random);
    const Element<PlanarBend<TangentCurvature>> tangent(random);
    const Element<RotationalSpring<2>> spring(random);
    CHECK(angle.gap(at_angle(before), at_angle(after)) < 1e-13);
    CHECK(tangent.gap(at_angle(before), at_angle(after)) < 1e-12);
    CHECK(spring.gap(at_angle(before), at_angle(after)) < 1e-13);
    // Without natural curvature a bend has the same energy on both sides, and no force between
    // them.
    Element<PlanarBend<AngleCurvature>> straight(random);
    straight.constants.rest_kappa = 0.0;
    straight.constants.actuated = {};
    const auto mirrored = at_angle(2.0 * kPi - before);
    CHECK(straight.discrete(at_angle(before), mirrored).norm() < 1e-12);
  }
}

TEST_CASE("discrete gradients of free elements add up to no force and no moment") {
  check_momenta<Stretch<2>>();
  check_momenta<AxialSpring<2>>();
  check_momenta<PlanarBend<AngleCurvature>>();
  check_momenta<PlanarBend<TangentCurvature>>();
}

}  // namespace der::test
