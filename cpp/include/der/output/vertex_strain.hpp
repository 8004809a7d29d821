#pragma once

#include "der/energies/effective_edge.hpp"
#include "der/kinematics/material_curvature.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {

/// The section frame of an edge of a model with sections, at a state: where the state's frames have
/// followed its coordinates they need no transport.
SectionFrame section_frame(const Model& model, Index edge, const State& state);

/// Director 1 of the section of each edge at a state, three components an edge; none without
/// sections. The positions may be other ones than those that the frames have followed last.
Vector directors_of(const Model& model, const State& state);

/// The section frame that a clamp in space holds at a state, but for its turn about the tangent.
SectionFrame held_frame(const HeldFrame& held, const Model& model, const State& state);

/// Curvatures and twist of a vertex of a rod in space at a state. Without sections, `kappa_1` is
/// the integrated curvature, in whatever direction, and the rest is zero.
MaterialCurvature strain_of(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                            const State& state);

/// Those of a vertex without stress, as actuations have them at a state.
MaterialCurvature rest_strain(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                              const State& state);

/// By how much internal damping lets a vertex bear more than its strain does, as a strain: times by
/// the rates of these. Zero without sections, where bending is not damped.
MaterialCurvature viscous_strain(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                                 const State& state);

/// Moment [N m] in a vertex of a rod whose sections count, exerted on the side before it, with that
/// of internal damping.
Vec3 moment_of(const RodVertex& vertex, const RodMesh& rod, const Model& model, const State& state);

/// The same of any rod in space: without sections, the vector about which it bends there.
Vec3 cell_moment(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                 const State& state);

/// Unit vector about which a rod in space bends at a vertex; zero where it does not.
Vec3 bend_axis(const RodVertex& vertex, const RodMesh& rod, const Model& model, const State& state);

/// The point [m] at which an edge of a rod in space begins or ends as its elements see it: a
/// clamp's pivot, or the node.
Vec3 effective_end(const SpatialEdge& edge, bool last, const Model& model, const State& state);

/// Vector [m] between these points.
Vec3 effective_vector(const SpatialEdge& edge, const Model& model, const State& state);

/// The rate [m/s] of the vector of an edge as its elements see it, in space and in a plane.
Vec3 effective_rate(const SpatialEdge& edge, const Model& model, const State& state);
Vec2 effective_rate(const EffectiveEdge& edge, const Model& model, const State& state);

/// The spin [rad/s] of the section that a clamp holds.
Vec3 held_spin(const HeldFrame& held, const Model& model, const State& state);

}  // namespace der
