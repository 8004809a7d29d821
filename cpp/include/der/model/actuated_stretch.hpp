#pragma once

#include <array>
#include <string>

#include "der/core/types.hpp"
#include "der/kinematics/natural_strain_offset.hpp"
#include "der/scenario/actuation.hpp"

namespace der {

/// A stretch of a rod on which an actuation changes the rest shape.
struct ActuatedStretch {
  std::string name;
  scenario::Actuated what = scenario::Actuated::Curvature;
  scenario::Profile profile = scenario::Profile::Constant;
  double from = 0.0, to = 0.0;            ///< rest arc length [m]
  std::array<Index, 2> controls{-1, -1};  ///< tables; the second of curvatures in space alone

  /// Whether it bends or twists the rod.
  [[nodiscard]] bool strains() const { return what != scenario::Actuated::Length; }
  /// The profile right before arc length `s` [m], or right after it.
  [[nodiscard]] double profile_at(double s, bool before) const;
  /// Integral [m] of the profile over a part of the rod.
  [[nodiscard]] double integral(double a, double b) const;
  /// Integral [m^2] of the profile times the distance from `a`.
  [[nodiscard]] double first_moment(double a, double b) const;
  /// Whether the profile jumps at the end of the stretch, or at its start.
  [[nodiscard]] bool jumps(bool at_end) const;
};

/// Where the controls have the shifts of the rest shape of a rod's elements: of each edge, of each
/// cell in which it bends, and of each place at which springs hold it against turning.
struct NaturalStrainEntries {
  Index edges = -1;    ///< entry of the first edge; -1: no actuation changes lengths
  Index cells = -1;    ///< entry of the first cell; -1: none changes curvatures or twist
  Index legs = -1;     ///< entry of the first end cell of a leg; -1: as of cells, or no legs
  Index springs = -1;  ///< entry of the first place with springs; -1: as of cells, or no springs
  Index strains = 1;   ///< entries of a cell and of a place: 1 in a plane, 3 in space

  /// Entry of the length of an edge.
  [[nodiscard]] NaturalStrainOffset edge(Index number) const {
    return {edges < 0 ? -1 : edges + number};
  }
  /// Entry of the cell about the node at a position in the rod, or on one side of a clamp there:
  /// between it and the edge that leaves it (`leaves`) or that arrives.
  [[nodiscard]] NaturalStrainOffset cell(Index position, bool leaves) const {
    return {cells < 0 ? -1 : cells + strains * (2 * position + (leaves ? 1 : 0))};
  }
  /// Entries of an end cell of a leg, by the leg's number in the rod: one for each of its angles.
  [[nodiscard]] NaturalStrainOffset end_cell(std::size_t leg, bool at_start) const {
    return {legs < 0 ? -1
                     : legs + kMostAngles * (2 * static_cast<Index>(leg) + (at_start ? 0 : 1))};
  }
  static constexpr Index kMostAngles = 3;
  /// Entry of a place with springs against turning, by its number among them.
  [[nodiscard]] NaturalStrainOffset spring(Index number) const {
    return {springs < 0 ? -1 : springs + strains * number};
  }
};

}  // namespace der
