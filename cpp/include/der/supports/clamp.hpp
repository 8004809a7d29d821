#pragma once

#include "der/core/types.hpp"
#include "der/energies/effective_edge.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

namespace scenario {
struct Support;
}

// A clamp holds a node and the tangent there. In the linear theory a chain with equal edges l,
// moment M_i = EI phi_i / l at node i, carries every load exactly, but for its nodes lying at y -
// (l^2/12) kappa beside the curve y. A clamp that lets the chain have that shape adds no error of
// its own: the edge next to the clamp then starts from a pivot at l/5 on the held tangent, it turns
// against the tangent over 25/48 l, and the next node over 47/48 l (in place of l/2 and l, an edge
// that starts from the node, and an error of order l^2). docs/mechanics.md derives it.

/// The edge that leaves a place, or at the end of a rod the one that arrives there.
Index edge_beside(const RodMesh& rod, Index place);
/// The place nearest to another at which two edges meet, on a rod of two edges or more.
Index inner_place_near(const RodMesh& rod, Index place);

/// Angle [rad] of the tangent at a node of the initial shape: that of the circle through the node's
/// neighbourhood, so that a clamp on an arc holds the arc's tangent and not the chord's. At a
/// corner that of the leg which leaves it.
double initial_tangent_angle(const RodMesh& rod, Index place, const Model& model);

/// Angle [rad] from the x axis at which a clamp holds the tangent in a state.
double tangent_angle(const Clamp& clamp, const Model& model, const State& state);

/// Calls use(control) for each control [rad] that turns a clamp.
template <class Use>
void for_each_turning_control(const Clamp& clamp, const Use& use) {
  for (const Index control : {clamp.rotation, clamp.held.rotation, clamp.held.twist}) {
    if (control >= 0) use(control);
  }
}

/// The same for all clamps of a model, and for its driven hinges.
template <class Use>
void for_each_turning_control(const Model& model, const Use& use) {
  for (const RodMesh& rod : model.rods) {
    for (const Clamp& clamp : rod.clamps) for_each_turning_control(clamp, use);
  }
  for (const Index control : model.driven_hinges) use(control);
}

inline bool any_clamp_turns(const Model& model) {
  bool any = false;
  for_each_turning_control(model, [&](Index /*control*/) { any = true; });
  return any;
}

/// The largest absolute value [rad] of the controls that turn the clamps of a model.
double largest_turn_of_clamps(const Model& model, const Vector& controls);

/// Enters a clamp into the layout of `rod`, which is one of the model's. The rod's elements are
/// made after it. Without effect on a rod that does not bend.
void hold_tangent(const scenario::Support& support, Index place, RodMesh& rod, Model& model);

EffectiveEdge effective_edge(const RodMesh& rod, Index edge, const Model& model);
/// The vector [m] in a state, with the clamps as they are turned there.
Vec2 effective_vector(const EffectiveEdge& effective, const Model& model, const State& state);
/// The point [m] about which an effective edge turns at its first or last end: a clamp's pivot, or
/// the node.
Vec2 effective_end(const EffectiveEdge& effective, bool last, const Model& model,
                   const State& state);

/// Length [m] over which the turning angle at a node without a clamp acts: its Voronoi length, less
/// 1/48 of an edge that a clamp ends.
double bend_length(const RodMesh& rod, Index place);
/// Length [m] over which an edge turns against the clamped tangent at its end: 25/48 of the edge.
double clamp_cell_length(const RodMesh& rod, Index edge);
/// Natural turning angle [rad] of that cell, from the start to the end of the rod.
double clamp_rest_angle(const RodMesh& rod, const Clamp& clamp, Index edge, const Model& model);
/// Where the moment of that cell acts, as a share of the edge from the clamp on: 1/5.
double clamp_pivot_share();

/// Adds the bending of a clamp's cells, one on either side of the node, and sets the node's rest
/// turning angle to their sum.
void add_clamp_cells(const Clamp& clamp, RodMesh& rod, Model& model);

}  // namespace der
