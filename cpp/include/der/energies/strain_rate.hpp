#pragma once

#include <type_traits>

#include "der/core/types.hpp"
#include "der/energies/arc_stretch.hpp"
#include "der/energies/axial_spring.hpp"
#include "der/energies/damping_times.hpp"
#include "der/energies/end_cell.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/joint_spring.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// The rates of an element's strains, B v + d: those of its extension [m/s], or of the curvatures
/// and the twist of its cell [1/s], as its energy counts them.
///
/// A kind of element with internal damping specialises it with
///   static constexpr int kSize;  // number of strains
///   static Mat3 viscosity(const Constants&, const DampingTimes&);  // DampedElement
///   static Gradient gradient(const Constants&, const Configuration& here, x);  // B
///   static Rates driven(const Constants&, const Configuration& here, x, const Gradient&,
///                       const Vector& turn_rates);
/// The latter is d, by controls that turn clamps and change by `turn_rates` a second. The
/// velocities of angles are the spins of sections (model/spin.hpp), so that B is without the
/// transport of frames.
template <class Kernel>
struct StrainRate {
  static constexpr bool kExists = false;
};

template <class Kernel, int Size>
struct StrainRateBase {
  using Constants = typename Kernel::Constants;
  using Local = Eigen::Matrix<double, Kernel::kDofs, 1>;
  using Rates = Eigen::Matrix<double, Size, 1>;
  using Gradient = Eigen::Matrix<double, Size, Kernel::kDofs>;
  static constexpr bool kExists = true;
  static constexpr int kSize = Size;

  static Rates driven(const Constants& /*c*/, const Configuration& /*here*/, const Local& /*x*/,
                      const Gradient& /*gradient*/, const Vector& /*turn_rates*/) {
    return Rates::Zero();
  }

 protected:
  static Mat3 single(double viscosity) { return Vec3(viscosity, 0.0, 0.0).asDiagonal(); }
};

template <int Dim>
struct StrainRate<Stretch<Dim>> : StrainRateBase<Stretch<Dim>, 1> {
  using Base = StrainRateBase<Stretch<Dim>, 1>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    return Base::single(times.stretching * c.EA / c.rest_length);
  }
  static typename Base::Gradient gradient(const typename Base::Constants& /*c*/,
                                          const Configuration& /*here*/,
                                          const typename Base::Local& x) {
    const Eigen::Matrix<double, Dim, 1> tangent = Stretch<Dim>::edge(x).normalized();
    typename Base::Gradient result;
    result << -tangent.transpose(), tangent.transpose();
    return result;
  }
};

template <class Curvature>
struct StrainRate<PlanarBend<Curvature>> : StrainRateBase<PlanarBend<Curvature>, 1> {
  using Base = StrainRateBase<PlanarBend<Curvature>, 1>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    return Base::single(times.bending * c.stiffness_per_length);
  }
  static typename Base::Gradient gradient(const typename Base::Constants& /*c*/,
                                          const Configuration& /*here*/,
                                          const typename Base::Local& x) {
    const auto [e0, e1] = PlanarBend<Curvature>::edges(x);
    const double slope = Curvature::of(angle_between(e0, e1)).first;
    const Vec2 d0 = slope * direction_gradient(e0, 1.0 / e0.squaredNorm());
    const Vec2 d1 = slope * direction_gradient(e1, 1.0 / e1.squaredNorm());
    typename Base::Gradient result;
    result << d0.transpose(), -(d0 + d1).transpose(), d1.transpose();
    return result;
  }
};

template <class Curvature>
struct StrainRate<PlanarClamp<Curvature>> : StrainRateBase<PlanarClamp<Curvature>, 1> {
  using Kernel = PlanarClamp<Curvature>;
  using Base = StrainRateBase<Kernel, 1>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    return Base::single(times.bending * c.stiffness_per_length);
  }
  static typename Base::Gradient gradient(const typename Base::Constants& c,
                                          const Configuration& here,
                                          const typename Base::Local& x) {
    const Vec2 e = edge(x);
    const Vec2 d = slope(c, here, e) * direction_gradient(e, 1.0 / e.squaredNorm());
    typename Base::Gradient result;
    result << -d.transpose(), d.transpose();
    return result;
  }
  static typename Base::Rates driven(const typename Base::Constants& c, const Configuration& here,
                                     const typename Base::Local& x,
                                     const typename Base::Gradient& /*gradient*/,
                                     const Vector& turn_rates) {
    if (c.rotation < 0) return Base::Rates::Zero();
    return typename Base::Rates(-slope(c, here, edge(x)) * turn_rates[c.rotation]);
  }

 private:
  static Vec2 edge(const typename Base::Local& x) {
    return x.template tail<2>() - x.template head<2>();
  }
  /// Derivative of the curvature by the direction of the edge.
  static double slope(const typename Base::Constants& c, const Configuration& here, const Vec2& e) {
    return c.side * Curvature::of(Kernel::turning_angle(c, here.controls, e)).first;
  }
};

template <class Curvature, int Edges, int Joints>
struct StrainRate<EndCell<Curvature, Edges, Joints>>
    : StrainRateBase<EndCell<Curvature, Edges, Joints>, Edges + Joints - 1> {
  using Kernel = EndCell<Curvature, Edges, Joints>;
  using Base = StrainRateBase<Kernel, Kernel::kAngles>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    Mat3 result = Mat3::Zero();
    result.topLeftCorner<Base::kSize, Base::kSize>() = times.bending * c.stiffness;
    return result;
  }
  static typename Base::Gradient gradient(const typename Base::Constants& c,
                                          const Configuration& here,
                                          const typename Base::Local& x) {
    return Kernel::gradients(c, c.driven.turned_by(here.controls, x));
  }
  static typename Base::Rates driven(const typename Base::Constants& c,
                                     const Configuration& /*here*/,
                                     const typename Base::Local& /*x*/,
                                     const typename Base::Gradient& gradient,
                                     const Vector& turn_rates) {
    const typename Base::Local still = Base::Local::Zero();
    return gradient * c.driven.turned_by(turn_rates, still);
  }
};

/// The rate is that of the angle between the sides; the damping is not that of a material.
template <>
struct StrainRate<JointSpring<2>> : StrainRateBase<JointSpring<2>, 1> {
  static Mat3 viscosity(const JointSpring<2>::Constants& c, const DampingTimes& times) {
    return single(times.bending * c.stiffness);
  }
  static Gradient gradient(const JointSpring<2>::Constants& /*c*/, const Configuration& /*here*/,
                           const Local& /*x*/) {
    return JointSpring<2>::gradient().transpose();
  }
  /// The viscosity of a hinge with a damping [N m s].
  static Mat3 of_hinge(double damping) { return single(damping); }
};

/// The rate is that of the length; the damping is not that of a material.
template <int Dim>
struct StrainRate<AxialSpring<Dim>> : StrainRateBase<AxialSpring<Dim>, 1> {
  using Base = StrainRateBase<AxialSpring<Dim>, 1>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    return Base::single(times.stretching * c.stiffness);
  }
  static typename Base::Gradient gradient(const typename Base::Constants& /*c*/,
                                          const Configuration& /*here*/,
                                          const typename Base::Local& x) {
    const auto tangent = AxialSpring<Dim>::vector(x).normalized().eval();
    typename Base::Gradient result;
    result << -tangent.transpose(), tangent.transpose();
    return result;
  }
  /// The viscosity of a spring with a damping [N s/m].
  static Mat3 of_spring(double damping) { return Base::single(damping); }
};

/// The strains are the extension of the arc and, with a negative viscosity, that of the edge, whose
/// part Stretch has.
template <int Edges, int Joints>
struct StrainRate<ArcStretch<Edges, Joints>> : StrainRateBase<ArcStretch<Edges, Joints>, 2> {
  using Kernel = ArcStretch<Edges, Joints>;
  using Base = StrainRateBase<Kernel, 2>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    const double viscosity = times.stretching * c.EA / c.rest_length;
    return Vec3(viscosity, -viscosity, 0.0).asDiagonal();
  }
  static typename Base::Gradient gradient(const typename Base::Constants& c,
                                          const Configuration& here,
                                          const typename Base::Local& x) {
    const auto [of_arc, of_edge] =
        Kernel::length_gradients(c, c.driven.turned_by(here.controls, x));
    typename Base::Gradient result;
    result << of_arc.transpose(), of_edge.transpose();
    return result;
  }
  static typename Base::Rates driven(const typename Base::Constants& c,
                                     const Configuration& /*here*/,
                                     const typename Base::Local& /*x*/,
                                     const typename Base::Gradient& gradient,
                                     const Vector& turn_rates) {
    const typename Base::Local still = Base::Local::Zero();
    return gradient * c.driven.turned_by(turn_rates, still);
  }
};

/// G' of strains s with s' = G' (the spin of the side after the vertex less that before it).
template <class Curvature>
Mat3 by_rotation(const VertexKinematics<Curvature>& vertex) {
  const auto of = vertex.gradients();
  Mat3 result;
  result << of.kappa_1.transpose(), of.kappa_2.transpose(), of.twist.transpose();
  return result;
}
/// How the vector of an edge turns its section.
inline Mat3 turned_by_vector(const EdgeFrame& edge) {
  return edge.per_length * cross_matrix(edge.frame.tangent);
}
/// The spin of a held section [rad/s].
inline Vec3 spin_of(const HeldFrame& held, const Vector& controls, const Vector& turn_rates) {
  Vec3 spin = Vec3::Zero();
  if (held.rotation >= 0) spin += turn_rates[held.rotation] * held.axis;
  if (held.twist >= 0) spin += turn_rates[held.twist] * held.tangent(controls);
  return spin;
}

/// Viscosity of two curvatures and a twist.
inline Mat3 vertex_viscosity(const Vertex& vertex, const DampingTimes& times) {
  return Vec3(times.bending * vertex.bend_1, times.bending * vertex.bend_2,
              times.twisting * vertex.twist)
      .asDiagonal();
}
/// That of a corner follows from its two halves (building/corner.hpp).
inline Mat3 vertex_viscosity(const CoupledVertex& /*vertex*/, const DampingTimes& /*times*/) {
  return Mat3::Zero();
}

template <class Curvature, class AVertex>
struct StrainRate<SpatialBend<Curvature, AVertex>>
    : StrainRateBase<SpatialBend<Curvature, AVertex>, 3> {
  using Kernel = SpatialBend<Curvature, AVertex>;
  using Base = StrainRateBase<Kernel, 3>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    return vertex_viscosity(c.vertex, times);
  }
  static typename Base::Gradient gradient(const typename Base::Constants& c,
                                          const Configuration& here,
                                          const typename Base::Local& x) {
    const auto [a, b, twist] = Kernel::frames(c, here.controls, x);
    const Mat3 turn = by_rotation(VertexKinematics<Curvature>(a.frame, b.frame, twist));
    const Mat3 by_a = turn * turned_by_vector(a);
    const Mat3 by_b = turn * turned_by_vector(b);
    typename Base::Gradient result;
    result << by_a, -by_a - by_b, by_b, -turn * a.frame.tangent, turn * b.frame.tangent;
    return result;
  }
};

template <class Curvature>
struct StrainRate<SpatialClamp<Curvature>> : StrainRateBase<SpatialClamp<Curvature>, 3> {
  using Kernel = SpatialClamp<Curvature>;
  using Base = StrainRateBase<Kernel, 3>;
  static Mat3 viscosity(const typename Base::Constants& c, const DampingTimes& times) {
    return vertex_viscosity(c.vertex, times);
  }
  static typename Base::Gradient gradient(const typename Base::Constants& c,
                                          const Configuration& here,
                                          const typename Base::Local& x) {
    const auto frames = Kernel::frames(c, here.controls, x);
    const Mat3 turn = c.side * by_rotation(Kernel::kinematics(c, here.controls, frames));
    const Mat3 by_edge = turn * turned_by_vector(frames.edge);
    typename Base::Gradient result;
    result << -by_edge, by_edge, turn * frames.edge.frame.tangent;
    return result;
  }
  static typename Base::Rates driven(const typename Base::Constants& c, const Configuration& here,
                                     const typename Base::Local& x,
                                     const typename Base::Gradient& /*gradient*/,
                                     const Vector& turn_rates) {
    const auto frames = Kernel::frames(c, here.controls, x);
    return -c.side * by_rotation(Kernel::kinematics(c, here.controls, frames)) *
           spin_of(c.held, here.controls, turn_rates);
  }
};

/// Velocity [m/s] of a pivot against its node.
inline Vec2 offset_rate(const Pivot& pivot, const Vector& controls, const Vector& turn_rates) {
  if (pivot.rotation < 0) return Vec2::Zero();
  return turn_rates[pivot.rotation] * perpendicular(pivot.offset(controls));
}
inline Vec3 offset_rate(const SpatialPivot& pivot, const Vector& controls,
                        const Vector& turn_rates) {
  return spin_of(pivot.held, controls, turn_rates).cross(pivot.offset(controls));
}

template <class Kernel, class PivotKind>
struct StrainRateFromPivot : StrainRate<Kernel> {
  using Element = StrainRate<Kernel>;
  using Pivoted = FromPivot<Kernel, PivotKind>;
  using Constants = typename Pivoted::Constants;
  static Mat3 viscosity(const Constants& c, const DampingTimes& times) {
    return Element::viscosity(c.element, times);
  }
  static auto gradient(const Constants& c, const Configuration& here,
                       const typename Element::Local& x) {
    return Element::gradient(c.element, here, Pivoted::from_pivots(c, here.controls, x));
  }
  static typename Element::Rates driven(const Constants& c, const Configuration& here,
                                        const typename Element::Local& x,
                                        const typename Element::Gradient& gradient,
                                        const Vector& turn_rates) {
    constexpr int dimension = PivotKind::kDimension;
    typename Element::Local pivots = Element::Local::Zero();
    pivots.template head<dimension>() = offset_rate(c.first, here.controls, turn_rates);
    pivots.template segment<dimension>(dimension * (Kernel::kNodes - 1)) =
        offset_rate(c.last, here.controls, turn_rates);
    return gradient * pivots + Element::driven(c.element, here,
                                               Pivoted::from_pivots(c, here.controls, x), gradient,
                                               turn_rates);
  }
};

template <class Kernel, class PivotKind>
struct StrainRate<FromPivot<Kernel, PivotKind>>
    : std::conditional_t<StrainRate<Kernel>::kExists, StrainRateFromPivot<Kernel, PivotKind>,
                         StrainRate<Kernel>> {};

}  // namespace der
