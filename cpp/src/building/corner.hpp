#pragma once

#include "der/energies/vertex_response.hpp"
#include "der/kinematics/section_frame.hpp"
#include "der/model/model.hpp"

namespace der {

// The cell about a node is half on the edge before it and half on the one after. At a corner these
// point elsewhere: the cell twists on one and bends on the other where a smooth curve does only one
// of both. Where a ring is glued turned, it bends about other directors. `curvature: tangent` does
// not resolve this, at corners not even in their plane.

/// G: a rotation w of the section after a vertex changes its strains by G' w.
template <class Curvature>
Mat3 gradients_of(const VertexKinematics<Curvature>& vertex) {
  const auto by_rotation = vertex.gradients();
  Mat3 gradients;
  gradients << by_rotation.kappa_1, by_rotation.kappa_2, by_rotation.twist;
  return gradients;
}

/// The vertex whose compliance at rest is the sum of its two halves. `drawn` is the vertex as
/// strains see it, `before` and `after` are the drawn frames of its two edges, `smooth` is the
/// vertex of a smooth curve, with stiffnesses greater than 0, and `share` the part of the cell that
/// lies before the node.
inline CoupledVertex corner_vertex(const SectionFrame& before, const SectionFrame& after,
                                   const VertexKinematics<AngleCurvature>& drawn, double share,
                                   const Vertex& smooth) {
  // A curvature towards director 1 is a rotation about director 2.
  const Vec3 compliance = Vec3(smooth.bend_2, smooth.bend_1, smooth.twist).cwiseInverse();
  const auto half = [&](const SectionFrame& frame) -> Mat3 {
    Mat3 axes;
    axes << frame.first, frame.second, frame.tangent;
    return axes * compliance.asDiagonal() * axes.transpose();
  };
  const Mat3 gradients = gradients_of(drawn);
  // Strains are s = G' w of a rotation w = C m under a moment m = G q.
  const Mat3 sum = share * half(before) + (1.0 - share) * half(after);
  return {(gradients.transpose() * sum * gradients).inverse(), smooth.rest};
}

/// How the strains of the two halves add up to those of the vertex `drawn` of its place.
template <class Curvature>
CellHalves cell_halves(Index place, const SectionFrame& before, const SectionFrame& after,
                       const VertexKinematics<Curvature>& drawn) {
  const Mat3 gradients = gradients_of(drawn);
  return {place, gradients.transpose() * turning_axes(before),
          gradients.transpose() * turning_axes(after)};
}

}  // namespace der
