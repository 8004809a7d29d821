#pragma once

#include "der/core/types.hpp"
#include "der/energies/arc_stretch.hpp"
#include "der/energies/end_cell.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/planar_bend.hpp"
#include "der/energies/planar_clamp.hpp"
#include "der/energies/rotational_spring.hpp"
#include "der/energies/section_spring.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/natural_strain_offset.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der {

/// Derivative of the energy of an element by what actuations add to its rest shape: the opposite of
/// its tension [N], or of its moments and torque [N m].
///
/// A kind of element that has a NaturalStrainOffset specialises it with
///   static constexpr int kSize;  // number of entries of the controls from the shift's on
///   static const NaturalStrainOffset& shift(const Constants&);
///   static Eigen::Matrix<double, kSize, 1> of(const Constants&, const Configuration& here, x);
template <class Kernel>
struct RestGradient {
  static constexpr bool kExists = false;
};

/// Elements that stretch have one elongation.
template <class Kernel>
struct StretchingRestGradient {
  static constexpr bool kExists = true;
  static constexpr int kSize = 1;
  static const NaturalStrainOffset& shift(const typename Kernel::Constants& c) {
    return c.elongation;
  }
};

template <int Dim>
struct RestGradient<Stretch<Dim>> : StretchingRestGradient<Stretch<Dim>> {
  using Kernel = Stretch<Dim>;
  static Eigen::Matrix<double, 1, 1> of(const typename Kernel::Constants& c,
                                        const Configuration& here,
                                        const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    const double length = Kernel::edge(x).norm();
    return Eigen::Matrix<double, 1, 1>(-Kernel::response(c, here.controls, length).tension);
  }
};

template <int Edges, int Joints>
struct RestGradient<ArcStretch<Edges, Joints>> : StretchingRestGradient<ArcStretch<Edges, Joints>> {
  using Kernel = ArcStretch<Edges, Joints>;
  static Eigen::Matrix<double, 1, 1> of(const typename Kernel::Constants& c,
                                        const Configuration& here,
                                        const typename Kernel::Coordinates& x) {
    return Eigen::Matrix<double, 1, 1>(Kernel::by_elongation(c, c.elongation.value(here.controls),
                                                             c.driven.turned_by(here.controls, x)));
  }
};

/// The same for elements that bend or twist: the opposite of a moment or torque for each strain.
template <class Kernel, int Size>
struct BendingRestGradient {
  using Constants = typename Kernel::Constants;
  using Local = Eigen::Matrix<double, Kernel::kDofs, 1>;
  using Moments = Eigen::Matrix<double, Size, 1>;
  static constexpr bool kExists = true;
  static constexpr int kSize = Size;
  static const NaturalStrainOffset& shift(const Constants& c) { return c.actuated; }

 protected:
  /// In a plane, at the curvature measure `kappa` [rad].
  static Moments planar(const Constants& c, const Configuration& here, double kappa) {
    return Moments(-c.stiffness_per_length * (kappa - c.natural(here.controls)));
  }
  /// In space, of a vertex's strain.
  template <class Strain>
  static Moments spatial(const Constants& c, const Configuration& here, const Strain& strain) {
    const auto [q1, q2, torque] = c.actuated_vertex(here.controls).load(strain);
    return {-q1, -q2, -torque};
  }
};

template <class Curvature>
struct RestGradient<PlanarBend<Curvature>> : BendingRestGradient<PlanarBend<Curvature>, 1> {
  using Kernel = PlanarBend<Curvature>;
  using Base = BendingRestGradient<Kernel, 1>;
  static auto of(const typename Base::Constants& c, const Configuration& here,
                 const typename Base::Local& x) {
    const auto [before, after] = Kernel::edges(x);
    return Base::planar(c, here, Curvature::of(angle_between(before, after)).kappa);
  }
};

template <class Curvature>
struct RestGradient<PlanarClamp<Curvature>> : BendingRestGradient<PlanarClamp<Curvature>, 1> {
  using Kernel = PlanarClamp<Curvature>;
  using Base = BendingRestGradient<Kernel, 1>;
  static auto of(const typename Base::Constants& c, const Configuration& here,
                 const typename Base::Local& x) {
    const Vec2 edge = x.template tail<2>() - x.template head<2>();
    const double angle = Kernel::turning_angle(c, here.controls, edge);
    return Base::planar(c, here, Curvature::of(angle).kappa);
  }
};

template <class Curvature, class AVertex>
struct RestGradient<SpatialBend<Curvature, AVertex>>
    : BendingRestGradient<SpatialBend<Curvature, AVertex>, 3> {
  using Kernel = SpatialBend<Curvature, AVertex>;
  using Base = BendingRestGradient<Kernel, 3>;
  static auto of(const typename Base::Constants& c, const Configuration& here,
                 const typename Base::Local& x) {
    const auto [a, b, twist] = Kernel::frames(c, here.controls, x);
    return Base::spatial(c, here, VertexKinematics<Curvature>(a.frame, b.frame, twist).strain());
  }
};

template <class Curvature>
struct RestGradient<SpatialClamp<Curvature>> : BendingRestGradient<SpatialClamp<Curvature>, 3> {
  using Kernel = SpatialClamp<Curvature>;
  using Base = BendingRestGradient<Kernel, 3>;
  static auto of(const typename Base::Constants& c, const Configuration& here,
                 const typename Base::Local& x) {
    const auto frames = Kernel::frames(c, here.controls, x);
    const MaterialCurvature strain = Kernel::kinematics(c, here.controls, frames).strain();
    auto moments = Base::spatial(c, here, strain);
    // Natural twist turns the section of a clamp that does not hold it, half as far in the cell's
    // middle.
    if (!c.holds_section) {
      moments[2] += 0.5 * c.side * (moments[0] * strain.kappa_2 - moments[1] * strain.kappa_1);
    }
    return moments;
  }
};

template <class Curvature, int Edges, int Joints>
struct RestGradient<EndCell<Curvature, Edges, Joints>> {
  using Kernel = EndCell<Curvature, Edges, Joints>;
  static constexpr bool kExists = true;
  static constexpr int kSize = Kernel::kAngles;
  static const NaturalStrainOffset& shift(const typename Kernel::Constants& c) {
    return c.actuated;
  }
  static typename Kernel::Angles of(const typename Kernel::Constants& c, const Configuration& here,
                                    const typename Kernel::Coordinates& x) {
    return -Kernel::loads(c, c.natural(here.controls), c.driven.turned_by(here.controls, x));
  }
};

template <int Edges>
struct RestGradient<RotationalSpring<Edges>> {
  using Kernel = RotationalSpring<Edges>;
  static constexpr bool kExists = true;
  static constexpr int kSize = 1;
  static const NaturalStrainOffset& shift(const typename Kernel::Constants& c) {
    return c.actuated;
  }
  static Eigen::Matrix<double, kSize, 1> of(const typename Kernel::Constants& c,
                                            const Configuration& here,
                                            const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    const double turn = Kernel::turn(c, here.controls[c.turn], x) + c.turned_by(here.controls);
    return Eigen::Matrix<double, kSize, 1>(c.stiffness * turn);
  }
};

template <int Edges>
struct RestGradient<SectionSpring<Edges>> {
  using Kernel = SectionSpring<Edges>;
  static constexpr bool kExists = true;
  static constexpr int kSize = 3;
  static const NaturalStrainOffset& shift(const typename Kernel::Constants& c) {
    return c.actuated;
  }
  static Vec3 of(const typename Kernel::Constants& c, const Configuration& here,
                 const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    return Kernel::by_actuated(c, here, x);
  }
};

template <class Kernel, class PivotKind>
struct RestGradient<FromPivot<Kernel, PivotKind>> : RestGradient<Kernel> {
  using Element = RestGradient<Kernel>;
  using Constants = typename FromPivot<Kernel, PivotKind>::Constants;
  static const NaturalStrainOffset& shift(const Constants& c) { return Element::shift(c.element); }
  static auto of(const Constants& c, const Configuration& here,
                 const Eigen::Matrix<double, Kernel::kDofs, 1>& x) {
    return Element::of(c.element, here,
                       FromPivot<Kernel, PivotKind>::from_pivots(c, here.controls, x));
  }
};

}  // namespace der
