#pragma once

#include "der/energies/damping_times.hpp"
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

/// Compliances about the directors and the tangent. A curvature towards director 1 is a rotation
/// about director 2.
inline Vec3 compliance_about_axes(const Vertex& smooth) {
  return Vec3(smooth.bend_2, smooth.bend_1, smooth.twist).cwiseInverse();
}

/// The sum over the halves of a cell of what each has about its own axes, by the strains of the
/// vertex.
inline Mat3 sum_of_halves(const SectionFrame& before, const SectionFrame& after,
                          const VertexKinematics<AngleCurvature>& drawn, double share,
                          const Vec3& about_axes) {
  const auto half = [&](const SectionFrame& frame) -> Mat3 {
    Mat3 axes;
    axes << frame.first, frame.second, frame.tangent;
    return axes * about_axes.asDiagonal() * axes.transpose();
  };
  const Mat3 gradients = gradients_of(drawn);
  const Mat3 sum = share * half(before) + (1.0 - share) * half(after);
  return gradients.transpose() * sum * gradients;
}

/// The vertex whose compliance at rest is the sum of its two halves. `drawn` is the vertex as
/// strains see it, `before` and `after` are the drawn frames of its two edges, `smooth` is the
/// vertex of a smooth curve, with stiffnesses greater than 0, and `share` the part of the cell that
/// lies before the node.
inline CoupledVertex corner_vertex(const SectionFrame& before, const SectionFrame& after,
                                   const VertexKinematics<AngleCurvature>& drawn, double share,
                                   const Vertex& smooth) {
  // Strains are s = G' w of a rotation w = C m under a moment m = G q.
  const Mat3 compliance = sum_of_halves(before, after, drawn, share, compliance_about_axes(smooth));
  return {compliance.inverse(), smooth.rest};
}

/// The viscosity (DampedElement) of the vertex `corner` that `corner_vertex` makes of the others,
/// whose two halves bear its moment each with its own damping, in the shares of their compliances.
inline Mat3 corner_viscosity(const CoupledVertex& corner, const SectionFrame& before,
                             const SectionFrame& after,
                             const VertexKinematics<AngleCurvature>& drawn, double share,
                             const Vertex& smooth, const DampingTimes& times) {
  const Vec3 about_axes = compliance_about_axes(smooth).cwiseProduct(
      Vec3(times.bending, times.bending, times.twisting));
  return corner.coefficients * sum_of_halves(before, after, drawn, share, about_axes) *
         corner.coefficients;
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
