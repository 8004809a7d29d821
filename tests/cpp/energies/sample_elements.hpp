#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <type_traits>

#include "der/energies/num_joints.hpp"
#include "der/energies/registry.hpp"

/// Random constants and configurations for every kind of element, for the checks that loop over the
/// registry. A new kind needs an overload of `sample_constants` here, or the tests do not compile.
namespace der::test {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// The controls that the sampled constants refer to, behind the frames of two edges.
enum Control : Index {
  kMoment = 2 * FrameBlock::kSize,
  kRotation,
  kTurn,
  kElongation,
  kDriven,
  kRestLength,
  kStrains,
  kJoints = kStrains + 3,  ///< blocks of two joints in space
  kNumControls = kJoints + 2 * JointBlock::kSize
};

inline Vec3 direction(Random& random) {
  return Vec3(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0))
      .normalized();
}

inline SectionFrame sample_frame(const Vec3& tangent, Random& random) {
  return SectionFrame::of(tangent, made_perpendicular(direction(random), tangent));
}

/// All that elements read of a configuration besides their own coordinates.
inline Configuration sample_configuration(Random& random) {
  Configuration here;
  here.controls.setZero(kNumControls);
  here.controls[kMoment] = uniform(random, -2.0, 2.0);
  here.controls[kRotation] = uniform(random, -1.0, 1.0);
  here.controls[kTurn] = uniform(random, -1.0, 1.0);
  here.controls[kElongation] = uniform(random, -0.1, 0.1);
  here.controls[kDriven] = 0.07;
  here.controls[kRestLength] = 1.1;
  for (Index i = kStrains; i < kJoints; ++i) here.controls[i] = uniform(random, -0.5, 0.5);
  return here;
}

template <int Dim>
typename Stretch<Dim>::Constants sample_constants(const Stretch<Dim>&, Random& random) {
  return {uniform(random, 1.0, 100.0), uniform(random, 0.5, 2.0), {kElongation}};
}

template <int Dim>
typename AxialSpring<Dim>::Constants sample_constants(const AxialSpring<Dim>&, Random& random) {
  return {uniform(random, 1.0, 100.0), kRestLength};
}

template <class Curvature>
typename PlanarBend<Curvature>::Constants sample_constants(const PlanarBend<Curvature>&,
                                                           Random& random) {
  return {uniform(random, 0.5, 5.0), uniform(random, -1.0, 1.0), {kStrains}};
}

template <class Curvature>
typename PlanarClamp<Curvature>::Constants sample_constants(const PlanarClamp<Curvature>&,
                                                            Random& random) {
  return {uniform(random, 0.5, 5.0),
          uniform(random, -1.0, 1.0),
          uniform(random, -0.5, 0.5),
          uniform(random, 0.0, 1.0) < 0.5 ? -1.0 : 1.0,
          kRotation,
          {kStrains}};
}

inline PlanarMoment::Constants sample_constants(const PlanarMoment&, Random& random) {
  return {uniform(random, 0.1, 1.0), kMoment};
}

template <int Dim>
typename Foundation<Dim>::Constants sample_constants(const Foundation<Dim>&, Random& random) {
  typename Foundation<Dim>::Constants c;
  for (double& stiffness : c.stiffness) stiffness = uniform(random, 0.0, 5.0);
  for (double& coordinate : c.drawn) coordinate = uniform(random, -1.0, 1.0);
  const double shared = uniform(random, 0.0, 0.2);
  c.lengths << uniform(random, 0.2, 0.5), shared, shared, uniform(random, 0.2, 0.5);
  return c;
}

template <int Dim, int Nodes>
typename PointSpring<Dim, Nodes>::Constants sample_constants(const PointSpring<Dim, Nodes>&,
                                                             Random& random) {
  typename PointSpring<Dim, Nodes>::Constants c;
  for (double& stiffness : c.stiffness) stiffness = uniform(random, 0.0, 5.0);
  for (double& coordinate : c.anchor) coordinate = uniform(random, -1.0, 1.0);
  for (int i = 0; i < Nodes; ++i) c.weights[i] = uniform(random, -0.1, 1.0);
  return c;
}

template <int Edges>
typename RotationalSpring<Edges>::Constants sample_constants(const RotationalSpring<Edges>&,
                                                             Random& random) {
  typename RotationalSpring<Edges>::Constants c;
  c.stiffness = uniform(random, 0.5, 5.0);
  c.direction = uniform(random, -0.5, 0.5);
  c.rest = uniform(random, -1.0, 1.0);
  c.turn = kTurn;
  c.actuated = {kStrains};
  c.total = uniform(random, 0.2, 1.2);
  c.weights.back() = Edges == 1 ? c.total : uniform(random, -0.1, 1.1);
  if constexpr (Edges == 2) c.weights.front() = c.total - c.weights.back();
  return c;
}

template <class Kernel>
typename FromPivot<Kernel>::Constants sample_constants(const FromPivot<Kernel>&, Random& random) {
  const auto pivot = [&] {
    // Short enough for edges that are nearly folded to stay so.
    return Pivot{uniform(random, -0.01, 0.01), uniform(random, -0.5, 0.5), kRotation};
  };
  return {sample_constants(Kernel{}, random), pivot(), pivot()};
}

/// A clamp whose tangent stays within 1.5 rad of the x axis.
inline HeldFrame sample_held_frame(Random& random) {
  HeldFrame held;
  held.drawn = sample_frame((Vec3::UnitX() + 0.4 * direction(random)).normalized(), random);
  held.axis = direction(random);
  held.rotation = kRotation;
  held.twist = kTurn;
  return held;
}

inline Vertex sample_vertex(Random& random) {
  const auto stiffness = [&] { return uniform(random, 0.5, 5.0); };
  return {stiffness(),
          stiffness(),
          stiffness(),
          {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -3.0, 3.0)}};
}

template <class Curvature>
typename IsotropicBend<Curvature>::Constants sample_constants(const IsotropicBend<Curvature>&,
                                                              Random& random) {
  return {uniform(random, 0.5, 5.0)};
}

template <class Curvature>
typename IsotropicClamp<Curvature>::Constants sample_constants(const IsotropicClamp<Curvature>&,
                                                               Random& random) {
  return {uniform(random, 0.5, 5.0), sample_held_frame(random)};
}

template <class Curvature>
typename SpatialBend<Curvature>::Constants sample_constants(const SpatialBend<Curvature>&,
                                                            Random& random) {
  return {sample_vertex(random),
          FrameBlock::of(0),
          FrameBlock::of(1),
          uniform(random, -3.0, 3.0),
          {kStrains}};
}

inline CornerBend::Constants sample_constants(const CornerBend&, Random& random) {
  CoupledVertex vertex;
  const Mat3 root = Mat3::NullaryExpr([&] { return uniform(random, -1.0, 1.0); });
  vertex.coefficients = Mat3::Identity() + root * root.transpose();
  vertex.rest = sample_vertex(random).rest;
  return {vertex, FrameBlock::of(0), FrameBlock::of(1), 0.0, {kStrains}};
}

template <class Curvature>
typename SpatialClamp<Curvature>::Constants sample_constants(const SpatialClamp<Curvature>&,
                                                             Random& random) {
  const double side = uniform(random, 0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  const bool holds_section = uniform(random, 0.0, 1.0) < 0.5;
  Vertex vertex = sample_vertex(random);
  if (!holds_section) vertex.twist = 0.0;
  return {vertex, sample_held_frame(random), FrameBlock::of(0), side, {kStrains}, holds_section};
}

inline Fork::Constants sample_constants(const Fork&, Random& random) {
  const double angle = uniform(random, -3.0, 3.0);
  return {uniform(random, 0.5, 5.0), {std::cos(angle), std::sin(angle)}, FrameBlock::of(0), kTurn};
}

inline CornerFork::Constants sample_constants(const CornerFork&, Random& random) {
  const auto side = [&](Index edge) -> CornerFork::Side {
    const double angle = uniform(random, -3.0, 3.0);
    return {{std::cos(angle), std::sin(angle)},
            {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)},
            FrameBlock::of(edge)};
  };
  return {uniform(random, 0.5, 5.0), side(0), side(1), kTurn};
}

template <class Kernel>
typename FromSpatialPivot<Kernel>::Constants sample_constants(const FromSpatialPivot<Kernel>&,
                                                              Random& random) {
  const auto pivot = [&] {
    return SpatialPivot{uniform(random, -0.01, 0.01), sample_held_frame(random)};
  };
  return {sample_constants(Kernel{}, random), pivot(), pivot()};
}

template <int Edges>
typename SectionSpring<Edges>::Constants sample_constants(const SectionSpring<Edges>&,
                                                          Random& random) {
  typename SectionSpring<Edges>::Constants c;
  c.actuated = {kStrains};
  const auto matrix = [&] {
    return Mat3(Mat3::NullaryExpr([&] { return uniform(random, -1, 1); }));
  };
  // Springs that are not there, soft, or all but rigid; no rod on the way, or some.
  constexpr double stiffnesses[] = {0.0, 0.4, 2.0, 1e7};
  const auto any_stiffness = [&] { return stiffnesses[int(uniform(random, 0.0, 3.999))]; };
  c.spring.stiffness = {any_stiffness(), any_stiffness(), any_stiffness()};
  const Mat3 factor = matrix();
  const bool counts_turns = uniform(random, 0.0, 1.0) < 0.5;
  if (counts_turns) {
    // Under the torque of whole turns a longer way would buckle.
    c.spring.stiffness = c.spring.stiffness.cwiseMin(2.0);
    c.spring.compliance.diagonal().setConstant(uniform(random, 0.0, 0.03));
  } else if (uniform(random, 0.0, 1.0) < 0.75) {
    c.spring.compliance = 0.1 * factor * factor.transpose() + 0.03 * Mat3::Identity();
  } else {
    c.spring.stiffness = c.spring.stiffness.cwiseMin(2.0);
  }
  const bool beside_clamp = Edges == 1 && !counts_turns;
  if (beside_clamp) c.clamp = {sample_held_frame(random), Mat3::Identity()};
  const Mat3 share = Edges == 1 && !beside_clamp ? Mat3(Mat3::Identity())
                                                 : Mat3(0.5 * Mat3::Identity() + 0.3 * matrix());
  for (int i = 0; i < Edges; ++i) {
    auto& held = c.edges[static_cast<std::size_t>(i)];
    held.block = FrameBlock::of(i);
    held.first = {uniform(random, -0.01, 0.01), sample_held_frame(random)};
    held.last = {uniform(random, -0.01, 0.01), sample_held_frame(random)};
    if (counts_turns) held.reference_twist = held.block.twist_at_end();
    held.weights = i == 0 ? share : Mat3(Mat3::Identity() - share);
  }
  return c;
}

template <class Curvature, int Edges, int Joints>
typename EndCell<Curvature, Edges, Joints>::Constants sample_constants(
    const EndCell<Curvature, Edges, Joints>&, Random& random) {
  typename EndCell<Curvature, Edges, Joints>::Constants c;
  using Stiffness = typename EndCell<Curvature, Edges, Joints>::Stiffness;
  const Stiffness root = Stiffness::NullaryExpr([&] { return uniform(random, -1.0, 1.0); });
  c.stiffness = Stiffness::Identity() + root * root.transpose();
  for (double& rest : c.rest) rest = uniform(random, -1.0, 1.0);
  for (double& angle : c.direction) angle = uniform(random, -0.5, 0.5);
  c.driven.control.back() = kDriven;
  c.actuated = {kStrains};
  return c;
}

template <int Edges, int Joints>
typename ArcStretch<Edges, Joints>::Constants sample_constants(const ArcStretch<Edges, Joints>&,
                                                               Random& random) {
  typename ArcStretch<Edges, Joints>::Constants c;
  c.EA = uniform(random, 1.0, 100.0);
  c.rest_length = uniform(random, 0.5, 2.0);
  using Form = typename ArcStretch<Edges, Joints>::Form;
  const Form form = Form::NullaryExpr([&] { return uniform(random, -0.05, 0.05); });
  c.form = form + form.transpose();
  c.edge = static_cast<int>(uniform(random, 0.0, Edges - 1e-9));
  for (double& angle : c.direction) angle = uniform(random, -0.5, 0.5);
  if constexpr (Joints > 0) c.driven.control.back() = kDriven;
  c.elongation = {kElongation};
  return c;
}

template <int Joints>
typename JointSpring<Joints>::Constants sample_constants(const JointSpring<Joints>&,
                                                         Random& random) {
  return {uniform(random, 0.5, 5.0)};
}

template <class Curvature, int Edges, int Joints>
typename SpatialEndCell<Curvature, Edges, Joints>::Constants sample_constants(
    const SpatialEndCell<Curvature, Edges, Joints>&, Random& random) {
  using Kernel = SpatialEndCell<Curvature, Edges, Joints>;
  typename Kernel::Constants c;
  const auto root =
      Kernel::Coupling::NullaryExpr([&] { return uniform(random, -1.0, 1.0); }).eval();
  c.per_compliance = Kernel::Coupling::Identity() + root * root.transpose();
  c.EI_1 = uniform(random, 0.5, 5.0);
  c.EI_2 = uniform(random, 0.5, 5.0);
  for (double& twist : c.twist) twist = uniform(random, 0.5, 5.0);
  for (double& rest : c.rest.reshaped()) rest = uniform(random, -1.0, 1.0);
  for (int i = 0; i < Edges; ++i) c.edges[std::size_t(i)] = FrameBlock::of(i);
  for (int i = 0; i < Joints; ++i) {
    c.joints[std::size_t(i)] = {sample_frame(direction(random), random),
                                {kJoints + i * JointBlock::kSize}};
  }
  c.leaves = Joints == 2 || uniform(random, 0.0, 1.0) < 0.5;
  return c;
}

inline SpatialJointSpring::Constants sample_constants(const SpatialJointSpring&, Random& random) {
  return {{uniform(random, 0.5, 5.0), uniform(random, 0.0, 5.0), uniform(random, 0.5, 5.0)},
          {sample_frame(direction(random), random), {kJoints}}};
}

enum class Shape { Arbitrary, NearStraight, NearFolded, Stretched };
constexpr Shape kShapes[] = {Shape::Arbitrary, Shape::NearStraight, Shape::NearFolded,
                             Shape::Stretched};

/// Nodes of a planar stencil with N coordinates: edges laid one after the other, each turned from
/// the one before by an angle that the shape decides. The first edge stays within 1.5 rad of the x
/// axis, the clamped direction within 0.5 + 1 rad of it: no angle crosses its cut at pi.
template <int N>
Eigen::Matrix<double, N, 1> sample_planar_positions(Shape shape, Random& random) {
  Eigen::Matrix<double, N, 1> x;
  x.template head<2>() << uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0);
  double direction = uniform(random, -1.5, 1.5);
  for (int node = 1; node < N / 2; ++node) {
    double length = uniform(random, 0.7, 1.4);
    if (shape == Shape::Stretched) length *= std::exp(uniform(random, -1.5, 1.5));
    x.template segment<2>(2 * node) = x.template segment<2>(2 * node - 2) +
                                      length * Vec2{std::cos(direction), std::sin(direction)};
    const double sign = uniform(random, -1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    switch (shape) {
      case Shape::NearStraight:
        direction += sign * std::pow(10.0, uniform(random, -9.0, -3.0));
        break;
      case Shape::NearFolded:
        direction += sign * (3.14159265358979 - uniform(random, 0.05, 0.2));
        break;
      default:
        direction += uniform(random, -2.5, 2.5);
    }
  }
  return x;
}

/// Whether a kernel has rotations of joints among its coordinates, behind those of its nodes.
template <class Kernel>
struct HasRotations : std::bool_constant<(NumJoints<Kernel>::value > 0)> {};

/// Whether the coordinates of a kernel are those of nodes in space, then angles of edges.
template <class Kernel, class = void>
struct IsSpatial : std::false_type {};
template <class Kernel>
struct IsSpatial<Kernel, std::void_t<decltype(Kernel::kNodes)>>
    : std::bool_constant<(Kernel::kDofs >= 3 * Kernel::kNodes) && !HasRotations<Kernel>::value> {};

/// As sample_planar_positions; the tangents of joints stay within 2.5 rad of the edges beside them.
template <class Kernel>
Eigen::Matrix<double, Kernel::kDofs, 1> sample_jointed_positions(Shape shape, Random& random) {
  constexpr int nodes = 2 * Kernel::kNodes;
  Eigen::Matrix<double, Kernel::kDofs, 1> x;
  for (int i = nodes; i < Kernel::kDofs; ++i) x[i] = uniform(random, -0.5, 0.5);
  if constexpr (nodes > 0) {
    x.template head<nodes>() = sample_planar_positions<nodes>(shape, random);
    if constexpr (Kernel::kJoints == 2) {
      const Vec2 last = x.template segment<2>(nodes - 2) - x.template segment<2>(nodes - 4);
      x[nodes + 1] += std::atan2(last.y(), last.x()) + uniform(random, -1.5, 1.5);
    }
  }
  return x;
}

/// As sample_planar_positions; each edge turns about any axis across the one before it. Angles of
/// edges are up to two turns.
template <class Kernel>
Eigen::Matrix<double, Kernel::kDofs, 1> sample_spatial_positions(Shape shape, Random& random) {
  Eigen::Matrix<double, Kernel::kDofs, 1> x;
  x.template head<3>() = direction(random);
  Vec3 tangent = (Vec3::UnitX() + 0.8 * direction(random)).normalized();
  for (int node = 1; node < Kernel::kNodes; ++node) {
    double length = uniform(random, 0.7, 1.4);
    if (shape == Shape::Stretched) length *= std::exp(uniform(random, -1.5, 1.5));
    x.template segment<3>(3 * node) = x.template segment<3>(3 * node - 3) + length * tangent;
    double angle = uniform(random, 0.0, 2.5);
    if (shape == Shape::NearStraight) angle = std::pow(10.0, uniform(random, -9.0, -3.0));
    if (shape == Shape::NearFolded) angle = 3.14159265358979 - uniform(random, 0.05, 0.2);
    tangent = Eigen::AngleAxisd(angle, made_perpendicular(direction(random), tangent)) * tangent;
  }
  for (int i = 3 * Kernel::kNodes; i < Kernel::kDofs; ++i) x[i] = uniform(random, -12.0, 12.0);
  return x;
}

template <class Kernel>
struct IsSpatialEndCell : std::false_type {};
template <class Curvature, int Edges, int Joints>
struct IsSpatialEndCell<SpatialEndCell<Curvature, Edges, Joints>> : std::true_type {};

template <class Kernel>
Eigen::Matrix<double, Kernel::kDofs, 1> sample_positions(Shape shape, Random& random) {
  if constexpr (IsSpatial<Kernel>::value || IsSpatialEndCell<Kernel>::value) {
    return sample_spatial_positions<Kernel>(shape, random);
  } else if constexpr (HasRotations<Kernel>::value) {
    return sample_jointed_positions<Kernel>(shape, random);
  } else {
    return sample_planar_positions<Kernel::kDofs>(shape, random);
  }
}

/// Frames of which those at `x` come by transport over up to half a radian. Returns the reference
/// frame at x.
inline SectionFrame sample_source(Index edge, const Vec3& vector, Random& random,
                                  Configuration& here) {
  const Vec3 tangent = vector.normalized();
  const SectionFrame source =
      sample_frame((tangent + 0.5 * direction(random)).normalized(), random);
  const FrameBlock block = FrameBlock::of(edge);
  here.controls.segment<3>(block.first) = source.tangent;
  here.controls.segment<3>(block.first + 3) = source.first;
  return EdgeFrame(vector, 0.0, source.tangent, source.first).frame;
}

/// Sets the frames that an element reads to some of which those at its coordinates are near.
template <class Kernel, class Coordinates>
void sample_frames(const Kernel& /*kernel*/, const typename Kernel::Constants& /*constants*/,
                   const Coordinates& /*x*/, Random& /*random*/, Configuration& /*here*/) {}

template <class Curvature, class AVertex, class Coordinates>
void sample_frames(const SpatialBend<Curvature, AVertex>& /*kernel*/,
                   const typename SpatialBend<Curvature, AVertex>::Constants& constants,
                   const Coordinates& x, Random& random, Configuration& here) {
  const Vec3 a = x.template segment<3>(3) - x.template segment<3>(0);
  const Vec3 b = x.template segment<3>(6) - x.template segment<3>(3);
  const SectionFrame before = sample_source(0, a, random, here);
  const SectionFrame after = sample_source(1, b, random, here);
  here.controls[constants.after.twist_at_start()] = twist_between(before, after);
}

template <class Curvature, class Coordinates>
void sample_frames(const SpatialClamp<Curvature>& /*kernel*/,
                   const typename SpatialClamp<Curvature>::Constants& constants,
                   const Coordinates& x, Random& random, Configuration& here) {
  const Vec3 e = x.template segment<3>(3) - x.template segment<3>(0);
  const SectionFrame edge = sample_source(0, e, random, here);
  const SectionFrame held = constants.held.untwisted(here.controls);
  here.controls[constants.edge.twist_at_start()] = twist_between(held, edge);
  here.controls[constants.edge.twist_at_end()] = twist_between(edge, held);
}

template <class Coordinates>
void sample_frames(const Fork& /*kernel*/, const Fork::Constants& /*constants*/,
                   const Coordinates& x, Random& random, Configuration& here) {
  sample_source(0, x.template segment<3>(3) - x.template segment<3>(0), random, here);
}

template <class Coordinates>
void sample_frames(const CornerFork& /*kernel*/, const CornerFork::Constants& /*constants*/,
                   const Coordinates& x, Random& random, Configuration& here) {
  sample_source(0, x.template segment<3>(3) - x.template segment<3>(0), random, here);
  sample_source(1, x.template segment<3>(6) - x.template segment<3>(3), random, here);
}

/// The sections that the edges and the clamp carry are within 0.5 rad of one, and the drawn one
/// within 1.5 rad and whole turns, or within 0.5 rad where a spring is all but rigid.
template <int Edges, class Coordinates>
void sample_frames(const SectionSpring<Edges>& /*kernel*/,
                   typename SectionSpring<Edges>::Constants& constants, const Coordinates& x,
                   Random& random, Configuration& here) {
  const SectionFrame near = sample_frame(direction(random), random);
  const auto turned = [&](double most) -> SectionFrame {
    const Mat3 turn =
        Eigen::AngleAxisd(uniform(random, 0.0, most), direction(random)).toRotationMatrix();
    return SectionFrame::of(turn * near.tangent, turn * near.first);
  };
  const auto axes = [](const SectionFrame& frame) {
    Mat3 matrix;
    matrix << frame.first, frame.second, frame.tangent;
    return matrix;
  };
  const Mat3 actuated =
      typename SectionSpring<Edges>::ActuatedRotation(constants, here.controls).turn;
  const SectionFrame drawn = turned(constants.spring.stiffness.maxCoeff() > 1e6 ? 0.5 : 1.5);
  constants.spring.drawn = drawn;
  const double turns = 6.283185307179586 * std::round(uniform(random, -1.5, 1.5));
  for (int i = 0; i < Edges; ++i) {
    auto& held = constants.edges[static_cast<std::size_t>(i)];
    const Vec3 e = x.template segment<3>(3 * i + 3) + held.last.offset(here.controls) -
                   x.template segment<3>(3 * i) - held.first.offset(here.controls);
    const double theta = x[3 * SectionSpring<Edges>::kNodes + i];
    const SectionFrame edge = sample_source(i, e, random, here).turned(theta);
    const SectionFrame section = turned(0.5);
    held.carried = axes(edge).transpose() * axes(section) * actuated.transpose();
    if (held.reference_twist >= 0) {
      here.controls[held.reference_twist] = theta - turns - twist_between(drawn, section);
    }
  }
  if (constants.clamp) {
    const HeldFrame& clamp = constants.clamp->held;
    const SectionFrame held =
        clamp.untwisted(here.controls).turned(clamp.twist_angle(here.controls));
    constants.clamp->carried = axes(held).transpose() * axes(turned(0.5)) * actuated.transpose();
  }
}

/// The sections of joints are turned by up to 1.5 rad from those of the edges beside them, and the
/// joints have turned by up to 1.7 rad since the start of the step. Twists are up to two turns.
template <class Curvature, int Edges, int Joints, class Coordinates>
void sample_frames(const SpatialEndCell<Curvature, Edges, Joints>& /*kernel*/,
                   const typename SpatialEndCell<Curvature, Edges, Joints>::Constants& c,
                   const Coordinates& x, Random& random, Configuration& here) {
  using Kernel = SpatialEndCell<Curvature, Edges, Joints>;
  std::array<SectionFrame, Kernel::kFrames> frames;
  std::array<double, Kernel::kFrames> turned{};
  for (int i = 0; i < Edges; ++i) {
    const Vec3 e = x.template segment<3>(3 * i + 3) - x.template segment<3>(3 * i);
    const double theta = x[3 * Kernel::kNodes + i];
    const auto frame = std::size_t(c.frame_of_edge(i));
    frames[frame] = sample_source(i, e, random, here).turned(theta);
    turned[frame] = theta;
  }
  const auto matrix = [](const SectionFrame& frame) {
    Mat3 axes;
    axes << frame.tangent, frame.first, frame.second;
    return axes;
  };
  for (int i = 0; i < Joints; ++i) {
    const auto frame = std::size_t(c.frame_of_joint(i));
    const SectionFrame& near = frames[frame == 0 ? 1 : frame - 1];
    const Mat3 turn =
        Eigen::AngleAxisd(uniform(random, 0.0, 1.5), direction(random)).toRotationMatrix();
    const Mat3 now = turn * matrix(near);
    frames[frame] = SectionFrame::of(now.col(0), now.col(1));
    const Vec3 delta = uniform(random, 0.0, 1.7) * direction(random);
    turned[frame] = delta.dot(now.col(0));
    const JointSection& joint = c.joints[std::size_t(i)];
    const Eigen::Quaterniond base =
        rotation_by(-delta) * Eigen::Quaterniond(Mat3(now * matrix(joint.drawn).transpose()));
    here.controls.segment<3>(joint.joint.first) =
        x.template segment<3>(Kernel::kDofs - Kernel::kJoints + 3 * i) - delta;
    here.controls.segment<4>(joint.joint.first + 3) << base.w(), base.vec();
  }
  for (int cell = 0; cell < Kernel::kCells; ++cell) {
    const auto k = std::size_t(cell);
    const double whole = 6.283185307179586 * std::round(uniform(random, -2.5, 2.5));
    here.controls[c.reference_twist(cell)] =
        twist_between(frames[k], frames[k + 1]) + whole - (turned[k + 1] - turned[k]);
  }
}

/// Joints that have turned by up to 2 rad, of which up to 1.7 rad since the start of the step.
template <class Coordinates>
void sample_frames(const SpatialJointSpring& /*kernel*/, const SpatialJointSpring::Constants& c,
                   const Coordinates& x, Random& random, Configuration& here) {
  const Vec3 delta = uniform(random, 0.0, 1.7) * direction(random);
  const Eigen::Quaterniond base =
      rotation_by(-delta) * rotation_by(uniform(random, 0.0, 2.0) * direction(random));
  here.controls.segment<3>(c.section.joint.first) = x - delta;
  here.controls.segment<4>(c.section.joint.first + 3) << base.w(), base.vec();
}

template <class Kernel, class Coordinates>
void sample_frames(const FromSpatialPivot<Kernel>& /*kernel*/,
                   const typename FromSpatialPivot<Kernel>::Constants& constants,
                   const Coordinates& x, Random& random, Configuration& here) {
  sample_frames(Kernel{}, constants.element, x, random, here);
}

}  // namespace der::test
