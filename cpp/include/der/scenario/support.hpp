#pragma once

#include <optional>
#include <string>
#include <vector>

#include "der/scenario/location.hpp"
#include "der/scenario/mark.hpp"
#include "der/scenario/series.hpp"

namespace der::scenario {

enum class Component { X, Y, Z };

/// A component that moves by a table: its displacement from the initial position [m].
struct Prescribed {
  Component component = Component::X;
  Series displacement;
};

/// An elastic support: pulls a place of a rod to an anchor, or its tangent to the initial
/// direction.
struct Spring {
  Components stiffness;               ///< [N/m] along each axis; empty: none
  Components anchor;                  ///< [m]; empty: the initial position of the place
  double rotational_stiffness = 0.0;  ///< [N m/rad]; 0: none
};

struct Support {
  std::string rod;
  Location at;
  std::vector<Component> fix;         ///< held at their initial value
  std::vector<Prescribed> prescribe;  ///< moved by a table
  bool clamp = false;                 ///< all components of the node and the tangent at it are held
  std::optional<Series> rotation;     ///< of the clamped tangent, from its initial direction [rad]
  std::optional<Spring> spring;
  Mark mark;

  /// Whether it holds nodes; otherwise it is only a spring, at any arc length.
  [[nodiscard]] bool holds() const { return clamp || !fix.empty() || !prescribe.empty(); }
};

}  // namespace der::scenario
