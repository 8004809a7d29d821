#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "der/scenario/rod.hpp"

/// How a rod and its sections lie in space, and what they resist, as far as the checks need it.
namespace der::scenario {

using Vec3 = Eigen::Vector3d;

/// Two or three components as three.
Vec3 in_space(const Components& components);
/// The component along z, which vectors of two components have not.
double along_z(const Components& components);

/// Whether the two bending stiffnesses are equal.
bool is_isotropic(const CrossSection& section);
/// Whether the rod does not resist bending.
bool is_cable(const Rod& rod);
/// Whether the scene tells how the rod resists twisting.
bool has_torsional_stiffness(const Rod& rod);
/// That of its material, or of its stiffnesses; none where neither could be read.
DampingTimes damping_of(const Rod& rod);
/// Whether all nodes lie on a line, but for rounding.
bool is_straight(const Rod& rod);
/// Whether all nodes have the same z.
bool is_flat(const Rod& rod);
/// Whether the director, +z without one, points across the rod where it begins.
bool has_width_direction(const Rod& rod);

/// Director 1 of a flat rod: the components of the unit vector along the normal z x t of the rod in
/// its plane, and along z.
struct FlatDirector {
  double normal = 0.0;
  double z = 1.0;

  /// A curvature toward the normal, as one toward the directors.
  [[nodiscard]] CurvaturePair pair(double curvature) const {
    return {curvature * normal, -curvature * z};
  }
  /// The part of a curvature toward the normal.
  [[nodiscard]] double in_plane(const CurvaturePair& pair) const {
    return pair.first * normal - pair.second * z;
  }
  /// The part of a curvature toward z.
  [[nodiscard]] double out_of_plane(const CurvaturePair& pair) const {
    return pair.first * z + pair.second * normal;
  }
};
FlatDirector flat_director(const Rod& rod);

/// A number below this fraction of those that it comes from is rounding.
inline constexpr double kRounding = 1e-12;

}  // namespace der::scenario
