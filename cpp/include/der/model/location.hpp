#pragma once

#include <optional>
#include <vector>

#include "der/core/types.hpp"
#include "der/model/model.hpp"
#include "der/model/node_weights.hpp"
#include "der/scenario/joint.hpp"
#include "der/scenario/location.hpp"

namespace der {

/// The part of an edge from one rest arc length [m] to another.
struct EdgePart {
  Index edge = 0;
  double from = 0.0, to = 0.0;
};

/// The turns around a rod after which a place on it may concern an edge (RodMesh: places of a
/// ring are counted on): 0, and of a ring one to either side.
std::vector<Index> turns_of(const RodMesh& rod);

/// The parts of a rod's edges that lie between two rest arc lengths [m].
std::vector<EdgePart> edge_parts(const RodMesh& rod, double from, double to);
/// Whether the part is less than its edge.
bool is_cut(const EdgePart& part, const RodMesh& rod);
/// Share of the last end of the edge in a uniform load on the part, as a length [m]: the integral
/// of (s - s0)/(s1 - s0) over it, the consistent load of linear interpolation.
double length_at_last_end(const EdgePart& part, const RodMesh& rod);

/// Rest arc length [m] at which the rod's tangent has the direction of an edge: the edge's middle,
/// or next to a clamp a little further away from it (model/clamp_cell.hpp).
double tangent_place(const RodMesh& rod, Index edge);

/// A place between a clamp and where the tangent has the direction of the edge beside it.
struct PlaceBesideClamp {
  Index clamp = 0;        ///< number in RodMesh::clamps
  Index edge = 0;         ///< number in the rod
  double distance = 0.0;  ///< from the clamp to the place [m]
  double reach = 0.0;     ///< from the clamp to where the tangent has the edge's direction [m]

  /// The weight of the edge's direction in the tangent at the place; the held one has the rest.
  [[nodiscard]] double share() const { return distance / reach; }
};

/// None for a place that is not beside a clamp.
std::optional<PlaceBesideClamp> place_beside_clamp(const RodMesh& rod, double s);

/// Distance [m] from the middle of the outermost edge to a place beyond it; 0 for places
/// inside, and beside a clamp.
double beyond_outer_middle(const RodMesh& rod, double s);

/// Rest arc length [m] that a location names (not for Kind::All). The end of a ring is its start.
double arc_length_of(const scenario::Location& location, const RodMesh& rod);

/// Rest arc lengths [m] that a location names: those of every node for Kind::All, else one.
std::vector<double> arc_lengths_of(const scenario::Location& location, const RodMesh& rod);

/// Position in RodMesh::nodes of the node at `location`. The reader has checked that there is
/// one.
Index node_at(const scenario::Location& location, const RodMesh& rod);
/// Positions in RodMesh::nodes of the nodes at `location`: every node for Kind::All, else one.
std::vector<Index> nodes_at(const scenario::Location& location, const RodMesh& rod);

/// The node at which the rods of a joint meet.
Index node_of(const scenario::Joint& joint, const Model& model);

/// Weights of the edges whose direction angles, linearly interpolated between the places where the
/// tangent has them, give the direction at arc length `s`. Beside a clamp they add up to less than
/// 1, as the clamp takes the rest. For a moment within half an edge of a free end the weights go on
/// to 13/12 and -1/12, which brings the end from the chain's place beside the curve onto it.
std::vector<Weighted> edge_weights(const RodMesh& rod, double s);

}  // namespace der
