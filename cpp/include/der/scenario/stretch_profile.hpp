#pragma once

#include "der/scenario/actuation.hpp"

namespace der::scenario {

/// A profile over the stretch that it is spread over.
struct StretchProfile {
  Profile kind = Profile::Constant;
  double from = 0.0, to = 0.0;  ///< rest arc length [m]

  /// The profile at an arc length `s` [m] of the stretch.
  [[nodiscard]] double at(double s) const;
  /// Integral [m] of the profile over a part of the rod.
  [[nodiscard]] double integral(double a, double b) const;
  /// Integral [m^2] of the profile times the distance from `a`.
  [[nodiscard]] double first_moment(double a, double b) const;
};

/// Turn [rad] between neighbouring edges from which on a mesh is coarse: the chord of an arc of
/// this angle is 4 % shorter than the arc.
inline constexpr double kCoarseTurn = 1.0;

/// Number of nodes, rounded, with which the edges of a rod [m] of an even curvature [1/m] turn by
/// half of that.
double fine_nodes(double curvature, double length);

/// Where an edge begins whose clamp holds the tangent, as a share of its length (kPivotShare in
/// model/clamp_cell.hpp).
inline constexpr double kEdgePivot = 1.0 / 5.0;

/// Turns of an edge against the rod before it, and of the rod after it against the edge, where
/// the curvature is 1 times a profile [m]. The edge has the mean direction of the curve along it;
/// from a clamp's pivot on it is shorter and turns by more (docs/actuation.md, "On the mesh").
struct EdgeTurns {
  double at_start = 0.0;
  double at_end = 0.0;
};
EdgeTurns edge_turns(const StretchProfile& profile, double start, double end, bool clamp_at_start,
                     bool clamp_at_end);

}  // namespace der::scenario
