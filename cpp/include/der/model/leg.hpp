#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/section_frame.hpp"

namespace der {

/// Where a leg meets a node.
struct LegEnd {
  /// Number of the joint's rotation that the leg's tangent follows (DofMap), in space of the first
  /// of three; -1: no moment acts between them.
  Index rotation = -1;
  double direction = 0.0;  ///< of the leg's tangent where the joint has not turned [rad]; planar
  SectionFrame section{};  ///< of the leg there, in space
  Index driven = -1;       ///< control by which a driven hinge turns the tangent besides [rad]
};

/// An edge of a leg whose arc is longer or shorter than it (energies/arc_stretch.hpp).
struct LegArc {
  int edges = 0;  ///< of its element
  int joints = 0;
  Index number = 0;  ///< of its element in its list
  Index edge = 0;    ///< counted from the start of the leg
  Index angle = 0;   ///< the node of the element's first turning angle, likewise
  int step = 1;      ///< -1 where the element runs from the end of the leg
};

/// A smooth piece of a rod. Joints are nodes with rotations of their own; all that acts
/// at a point acts on a joint, and legs between joints are plain chains with an end cell at each
/// end (energies/end_cell.hpp, spatial_end_cell.hpp).
struct Leg {
  Index first = 0;  ///< position of its first node in RodMesh::nodes
  Index last = 0;   ///< of its last one
  LegEnd start;
  LegEnd end;
  // Numbers of its elements in their lists.
  Index start_cell = -1;  ///< the end cell at its start; where one has both ends, it is this
  Index end_cell = -1;
  Index first_bend = -1;  ///< the bends at nodes between end cells follow one another
  std::vector<LegArc> arcs{};
  [[nodiscard]] Index num_cells() const { return last - first; }
  /// Whether the end cell of a joint has the bending at a node: it is next to the joint.
  [[nodiscard]] bool in_end_cell(Index place) const {
    return (start.rotation >= 0 && place == first + 1) || (end.rotation >= 0 && place == last - 1);
  }
};

/// The turning angles next to an end of a leg, times EI, that a moment makes which is linear along
/// the leg: C m, from the end on. m are the moments at the end, at the node next to it, and on a
/// leg of two cells at its other end; on one of one cell, those at its two ends. Ends of legs are
/// on the curve. Other nodes are beside it, by l^2/12 of the curvature, l the length of their
/// cells. `edge_length`: of the rod's edges [m].
Mat3 end_compliance(const Leg& leg, bool from_start, const std::vector<double>& edge_length);

}  // namespace der
