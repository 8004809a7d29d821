#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/mark.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

enum class Component { X, Y, Z };
/// "x", "y" or "z".
const char* name_of(Component component);

/// A component that moves by a table: its displacement from the initial position [m].
struct Prescribed {
  Component component = Component::X;
  Series displacement;
};

/// An elastic support: pulls a place of a rod to an anchor, or its section to the initial
/// orientation.
struct Spring {
  Components stiffness;  ///< [N/m] along each axis; empty: none
  Components anchor;     ///< [m]; empty: the initial position of the place
  /// [N m/rad] Against turning towards the first director, towards the second, and about the
  /// tangent; in a planar model all three are that in the plane. Empty: none.
  Components rotational_stiffness;
};

/// A clamp holds its node, and besides:
enum class Clamp {
  None,     ///< there is no clamp
  Section,  ///< the tangent and the section: all that a wall holds
  Tangent,  ///< the tangent; the rod is free to spin about it
};

/// A rotation about an axis that keeps its direction.
struct AxisRotation {
  Components axis;  ///< three components, any length
  Series angle;     ///< [rad], right-handed
};

struct Support {
  std::string name;   ///< by which programs set it and overrides find it; empty: none
  std::string joint;  ///< in place of the rod and the place, which the checks then set
  std::string rod;
  Location at;
  std::vector<Component> fix;         ///< held at their initial value
  std::vector<Prescribed> prescribe;  ///< moved by a table
  Clamp clamp = Clamp::None;
  std::vector<Component> free;  ///< of a clamp: its node moves along them
  /// Planar model: rotation of the clamped tangent about z, from its initial direction [rad].
  std::optional<Series> rotation;
  /// Spatial models: rotation of the clamped tangent, and of a clamped section with it.
  std::optional<AxisRotation> axis_rotation;
  /// Rotation of a clamped section about the held tangent [rad], right-handed about the direction
  /// of growing arc length. It comes on top of `axis_rotation`.
  std::optional<Series> twist;
  std::optional<Spring> spring;
  Mark mark;

  /// Whether it holds nodes; otherwise it is only a spring, at any arc length.
  [[nodiscard]] bool holds() const { return clamps() || !fix.empty() || !prescribe.empty(); }
  [[nodiscard]] bool clamps() const { return clamp != Clamp::None; }
  /// Whether it is a clamp that holds this component of its node.
  [[nodiscard]] bool clamps(Component component) const {
    return clamps() && std::find(free.begin(), free.end(), component) == free.end();
  }
};

/// Calls `use(key, table)` with every motion of a support, its key that under `prescribe`.
/// `Support` may be const.
template <class Support, class Use>
void for_each_motion(Support& support, Use&& use) {
  for (auto& motion : support.prescribe) use(name_of(motion.component), motion.displacement);
  if (support.rotation) use("angle", *support.rotation);
  if (support.axis_rotation) use("rotation.angle", support.axis_rotation->angle);
  if (support.twist) use("twist", *support.twist);
}

}  // namespace der::scenario
