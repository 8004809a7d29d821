// Internal damping of each kind of element: the rates of its strains against central differences of
// the loads that it bears, which are linear in the strains, and what follows from the form B' V B
// of the viscous forces.
#include "der/energies/strain_rate.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <type_traits>

#include "der/energies/num_joints.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/rest_gradient.hpp"
#include "der/energies/viscous_term.hpp"
#include "energies/sample_elements.hpp"

namespace der::test {
namespace {

/// Follows the frames of an element to its coordinates: the rates of angles are then spins.
template <class Kernel>
void follow_frames(const Kernel& /*kernel*/, const typename Kernel::Constants& /*constants*/,
                   const Eigen::Matrix<double, Kernel::kDofs, 1>& /*x*/, Configuration& /*here*/) {}

void follow_frame(const FrameBlock& block, const SectionFrame& untwisted, Configuration& here) {
  here.controls.segment<3>(block.first) = untwisted.tangent;
  here.controls.segment<3>(block.first + 3) = untwisted.first;
}

template <class Curvature, class AVertex>
void follow_frames(const SpatialBend<Curvature, AVertex>& /*kernel*/,
                   const typename SpatialBend<Curvature, AVertex>::Constants& c,
                   const Eigen::Matrix<double, 11, 1>& x, Configuration& here) {
  const auto frames = SpatialBend<Curvature, AVertex>::frames(c, here.controls, x);
  follow_frame(c.before, frames.a.frame.turned(-x[9]), here);
  follow_frame(c.after, frames.b.frame.turned(c.glued - x[10]), here);
}

template <class Curvature>
void follow_frames(const SpatialClamp<Curvature>& /*kernel*/,
                   const typename SpatialClamp<Curvature>::Constants& c,
                   const Eigen::Matrix<double, 7, 1>& x, Configuration& here) {
  const auto frames = SpatialClamp<Curvature>::frames(c, here.controls, x);
  follow_frame(c.edge, frames.edge.frame.turned(-x[6]), here);
}

template <class Kernel, class PivotKind>
void follow_frames(const FromPivot<Kernel, PivotKind>& /*kernel*/,
                   const typename FromPivot<Kernel, PivotKind>::Constants& c,
                   const Eigen::Matrix<double, Kernel::kDofs, 1>& x, Configuration& here) {
  follow_frames(Kernel{}, c.element, FromPivot<Kernel, PivotKind>::from_pivots(c, here.controls, x),
                here);
}

/// The stiffness of its strains.
template <class Kernel>
Mat3 stiffness_of(const Kernel& /*kernel*/, const typename Kernel::Constants& c) {
  return StrainRate<Kernel>::viscosity(c, {1.0, 1.0, 1.0});
}
Mat3 stiffness_of(const CornerBend& /*kernel*/, const CornerBend::Constants& c) {
  return c.vertex.coefficients;
}
Mat3 stiffness_of(const FromSpatialPivot<CornerBend>& /*kernel*/,
                  const FromSpatialPivot<CornerBend>::Constants& c) {
  return c.element.vertex.coefficients;
}

/// The loads of an element's strains.
template <class Kernel>
struct StrainLoads {
  using Loads = typename StrainRate<Kernel>::Rates;
  static Loads of(const typename Kernel::Constants& c, const Configuration& here,
                  const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    return -RestGradient<Kernel>::of(c, here, x);
  }
  /// What `of` tells of them.
  static Loads known(const Loads& loads) { return loads; }
};
template <>
struct StrainLoads<JointSpring<2>> {
  using Loads = Eigen::Matrix<double, 1, 1>;
  static Loads of(const JointSpring<2>::Constants& c, const Configuration& /*here*/,
                  const Vec2& x) {
    return Loads(c.stiffness * (x[1] - x[0]));
  }
  static Loads known(const Loads& loads) { return loads; }
};
template <int Dim>
struct StrainLoads<AxialSpring<Dim>> {
  using Loads = Eigen::Matrix<double, 1, 1>;
  static Loads of(const typename AxialSpring<Dim>::Constants& c, const Configuration& here,
                  const typename AxialSpring<Dim>::Coordinates& x) {
    return Loads(c.stiffness * (AxialSpring<Dim>::vector(x).norm() - here.controls[c.rest_length]));
  }
  static Loads known(const Loads& loads) { return loads; }
};
/// Of an arc and of its edge only the sum is that of an elongation.
template <int Edges, int Joints>
struct StrainLoads<ArcStretch<Edges, Joints>> {
  using Kernel = ArcStretch<Edges, Joints>;
  static Vec2 of(const typename Kernel::Constants& c, const Configuration& here,
                 const typename Kernel::Coordinates& x) {
    return {-RestGradient<Kernel>::of(c, here, x)[0], 0.0};
  }
  static Vec2 known(const Vec2& loads) { return {loads.sum(), 0.0}; }
};

/// An element by itself, of which a viscosity is known.
template <class Kernel>
struct Sample {
  ElementList<Kernel> list;
  DampedElement damped;
  Configuration here;
  Vector velocities;
  Vector turn_rates;

  Sample(const typename Kernel::Constants& constants, Random& random) {
    std::array<Index, Kernel::kDofs> dofs;
    for (std::size_t i = 0; i < dofs.size(); ++i) dofs[i] = static_cast<Index>(i);
    list.add(dofs, constants);
    here = sample_configuration(random);
    const auto x = sample_positions<Kernel>(Shape::Arbitrary, random);
    sample_frames(Kernel{}, constants, x, random, here);
    follow_frames(Kernel{}, constants, x, here);
    here.coordinates = x;
    velocities = Vector::NullaryExpr(x.size(), [&] { return uniform(random, -1.0, 1.0); });
    turn_rates.setZero(here.controls.size());
    turn_rates[kRotation] = uniform(random, -1.0, 1.0);
    turn_rates[kTurn] = uniform(random, -1.0, 1.0);
    const Mat3 root = Mat3::NullaryExpr([&] { return uniform(random, -1.0, 1.0); });
    damped.viscosity = root * root.transpose();
  }
  [[nodiscard]] Moving moving() const { return {here, velocities, turn_rates}; }
};

template <class Kernel>
void check_rates(Random& random) {
  using Strain = StrainRate<Kernel>;
  constexpr int n = Strain::kSize;
  const auto constants = sample_constants(Kernel{}, random);
  const Sample<Kernel> sample(constants, random);
  const auto loads_after = [&](double time) {
    Configuration there = sample.here;
    there.coordinates += time * sample.velocities;
    there.controls += time * sample.turn_rates;
    const Eigen::Matrix<double, Kernel::kDofs, 1> x = there.coordinates;
    return typename Strain::Rates(StrainLoads<Kernel>::of(constants, there, x));
  };
  const auto rise = [&](double h) ->
      typename Strain::Rates { return (loads_after(h) - loads_after(-h)) / (2.0 * h); };
  constexpr double h = 1e-3;
  const typename Strain::Rates slope = 1.5 * rise(h) - 0.6 * rise(2.0 * h) + 0.1 * rise(3.0 * h);
  const Eigen::Matrix<double, Kernel::kDofs, 1> x = sample.here.coordinates;
  const typename Strain::Gradient gradient = Strain::gradient(constants, sample.here, x);
  const typename Strain::Rates rates =
      gradient * sample.velocities +
      Strain::driven(constants, sample.here, x, gradient, sample.turn_rates);
  const Mat3 stiffness = stiffness_of(Kernel{}, constants);
  const typename Strain::Rates expected =
      StrainLoads<Kernel>::known(stiffness.template topLeftCorner<n, n>() * rates);
  // A vertex that is nearly folded has large derivatives. The torque of a clamp that lets the
  // section turn is none: its gradient by the rest shape is that of its moments.
  const int compared = n < 3 || stiffness(n - 1, n - 1) > 0.0 ? n : 2;
  const double scale = 1.0 + expected.norm() + loads_after(0.0).norm();
  CHECK((slope - expected).head(compared).norm() < 1e-7 * scale * (1.0 + gradient.norm()));
}

template <class Kernel>
void check_matrix(Random& random) {
  const auto constants = sample_constants(Kernel{}, random);
  const Sample<Kernel> sample(constants, random);
  const auto matrix = viscous_matrix(sample.list, sample.damped, sample.here);
  const double size = matrix.norm();
  CHECK(size > 0.0);
  CHECK((matrix - matrix.transpose()).norm() < 1e-14 * size);
  // One solver for all sizes: it compiles for long.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  CHECK(solver.eigenvalues().minCoeff() > -1e-14 * size);
  // The forces are the matrix times the velocities, and what turns clamps takes part.
  const Vector no_rates;
  const auto still =
      viscous_term(sample.list, sample.damped, {sample.here, sample.velocities, no_rates});
  CHECK((still.gradient - matrix * sample.velocities).norm() <
        1e-13 * size * sample.velocities.norm());
  CHECK(still.driven == 0.0);
  const auto term = viscous_term(sample.list, sample.damped, sample.moving());
  CHECK(term.gradient.dot(sample.velocities) + term.driven > -1e-13 * size);
}

/// A rigid motion, of sections and pivots too, gives no force.
template <class Kernel>
void check_rigid_motion(Random& random) {
  const auto constants = sample_constants(Kernel{}, random);
  Sample<Kernel> sample(constants, random);
  constexpr bool in_space = IsSpatial<Kernel>::value;
  constexpr int dimension = in_space ? 3 : 2;
  constexpr int joints = NumJoints<Kernel>::value;
  constexpr int nodes = in_space ? Kernel::kNodes : (Kernel::kDofs - joints) / 2;
  const Vec3 spin = in_space ? direction(random) : Vec3(Vec3::UnitZ());
  const Vec3 shift = direction(random);
  const Vector& x = sample.here.coordinates;
  const auto node = [&](int i) {
    Vec3 point = Vec3::Zero();
    point.head<dimension>() = x.template segment<dimension>(dimension * i);
    return point;
  };
  for (int i = 0; i < nodes; ++i) {
    sample.velocities.template segment<dimension>(dimension * i) =
        (shift + spin.cross(node(i))).template head<dimension>();
  }
  sample.velocities.template tail<joints>().setConstant(spin.z());
  for (int edge = 0; dimension * nodes + joints + edge < Kernel::kDofs; ++edge) {
    sample.velocities[dimension * nodes + edge] =
        spin.dot((node(edge + 1) - node(edge)).normalized());
  }
  sample.turn_rates.setConstant(in_space ? 0.0 : spin.z());
  sample.turn_rates[kDriven] = 0.0;  // between two rods
  const double size = viscous_matrix(sample.list, sample.damped, sample.here).norm();
  CHECK(viscous_term(sample.list, sample.damped, sample.moving()).gradient.norm() < 1e-13 * size);
}

/// Calls check(kernel) for each kind that can have internal damping; returns how many there are.
template <class Check>
int for_each_damped_kind(const Check& check) {
  int kinds = 0;
  for_each_list(ElementLists{}, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (StrainRate<Kernel>::kExists) {
      for (int i = 0; i < 50; ++i) check(Kernel{});
      ++kinds;
    }
  });
  return kinds;
}

template <class Kernel>
struct HasSpatialClamp : std::false_type {};
template <class Kernel>
struct HasSpatialClamp<FromSpatialPivot<Kernel>> : std::true_type {};

}  // namespace

TEST_CASE("rates of strains are those of the loads over the stiffness") {
  Random random(11);
  const int kinds =
      for_each_damped_kind([&](auto kernel) { check_rates<decltype(kernel)>(random); });
  // All that hold a rod together but IsotropicBend, which has no sections.
  CHECK(kinds == 37);
}

TEST_CASE("the matrix of viscous forces is symmetric and takes energy") {
  Random random(12);
  for_each_damped_kind([&](auto kernel) { check_matrix<decltype(kernel)>(random); });
}

TEST_CASE("rigid motions feel no internal damping") {
  Random random(13);
  for_each_damped_kind([&](auto kernel) {
    // The axes of the samples' clamps in space differ.
    if constexpr (!HasSpatialClamp<decltype(kernel)>::value) {
      check_rigid_motion<decltype(kernel)>(random);
    }
  });
}

}  // namespace der::test
