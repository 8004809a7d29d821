#pragma once

#include "der/core/index.hpp"
#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/model/model.hpp"

namespace der {

// The forces on nodes by which the spin of sections enters the equations of motion: the part of
// the elastic forces that the spin's inertia takes up, and the gyroscopic couple (docs/space.md,
// "Mechanics"). Each acts on the two ends of an edge, opposite to one another.

/// Force [N] on the end of an edge whose ends have the relative velocity `rate` [m/s], and its
/// opposite on the start, by which a section resists the turning of its tangent t: the angular
/// momentum `spin` [kg m^2/s] along t changes by spin t', and the couple on the nodes is the
/// opposite. Linear in the velocities, at right angles to t', so that it does no work.
template <class T>
Vector3<T> gyroscopic_force(const Vector3<T>& edge, const Vector3<T>& rate, const T& spin) {
  const T length = edge.norm();
  return edge.cross(rate) * (spin / (length * length * length));
}

/// Takes from `forces` on nodes, for each edge with a section, `force(edge, number, vector)` at its
/// end and the opposite at its start; `number` counts the edges, `vector` is that of the edge.
template <class Force>
void take_pairs(const Model& model, const Configuration& here, Force&& force, Vector& forces) {
  for (std::size_t i = 0; i < model.framed_edges.size(); ++i) {
    const SpatialEdge& edge = model.framed_edges[i];
    const Vec3 pair =
        force(edge, static_cast<Index>(i), edge.vector(here.coordinates, here.controls));
    forces.segment<3>(edge.start) += pair;
    forces.segment<3>(edge.end) -= pair;
  }
}

/// The part T a of the elastic force on an edge's end [N]: what the transport of frames from their
/// source, with its spin a, makes of the torque T [N m].
template <class T>
Vector3<T> transport_force(const Vector3<T>& edge, const Vector3<T>& source, const T& torque) {
  return torque * transport_spin<T>(edge, source);
}
inline Vec3 transport_force(const Vec3& edge, Index number, double torque, const Vector& controls) {
  return transport_force<double>(edge, FrameBlock::of(number).tangent(controls), torque);
}

/// The gyroscopic force on an edge's end [N], where `velocity(dof)` is the rate of a degree of
/// freedom. The velocity of a clamp's pivot against its node is left out: the couple on that one
/// edge is then wrong by a share, which changes the shape by the order of the edge squared, and the
/// forces still do no work on the nodes. The moment of the clamp makes up for it
/// (output/reactions.cpp).
template <class Velocity>
Vec3 gyroscopic_force(const SpatialEdge& edge, const Vec3& vector, const Mass& mass,
                      Velocity&& velocity) {
  Vec3 rate;
  for (int c = 0; c < 3; ++c) rate[c] = velocity(edge.end + c) - velocity(edge.start + c);
  return gyroscopic_force<double>(vector, rate, mass.lumped[edge.theta] * velocity(edge.theta));
}

}  // namespace der
