#include "der/model/frames.hpp"

#include "der/core/index.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/model/model.hpp"

namespace der {

SectionFrame reference_frame(Index edge, const Eigen::Ref<const Vector>& frames) {
  const FrameBlock block = FrameBlock::of(edge);
  return SectionFrame::of(block.tangent(frames), block.director(frames));
}

void follow_frames(const Model& model, const Vector& coordinates, const Vector& controls,
                   Eigen::Ref<Vector> frames) {
  for (Index edge = 0; edge < static_cast<Index>(model.framed_edges.size()); ++edge) {
    const FrameBlock block = FrameBlock::of(edge);
    const SectionFrame moved =
        moved_frame<double>(block.tangent(frames), block.director(frames),
                            model.framed_edges[to_size(edge)].vector(coordinates, controls));
    frames.segment<3>(block.first) = moved.tangent;
    frames.segment<3>(block.first + 3) = moved.first;
  }
  for (const FramedVertex& vertex : model.framed_vertices) {
    const SectionFrame before = vertex.before >= 0 ? reference_frame(vertex.before, frames)
                                                   : vertex.held.untwisted(controls);
    const SectionFrame after =
        vertex.after >= 0 ? reference_frame(vertex.after, frames) : vertex.held.untwisted(controls);
    double& twist = frames[vertex.twist()];
    twist = nearest_turn(twist_between(before, after), twist);
  }
}

Index frame_turned_too_far(const Model& model, const Vector& coordinates, const Vector& controls,
                           const Eigen::Ref<const Vector>& frames) {
  for (Index edge = 0; edge < static_cast<Index>(model.framed_edges.size()); ++edge) {
    const Vec3 vector = model.framed_edges[to_size(edge)].vector(coordinates, controls);
    if (FrameBlock::of(edge).tangent(frames).dot(vector) < 0.0) return edge;
  }
  return -1;
}

SectionFrame initial_frame(const Model& model, Index edge) {
  const double theta = model.reference_positions[model.framed_edges[to_size(edge)].theta];
  return reference_frame(edge, model.initial_frames).turned(theta);
}

SectionFrame section_frame(const Model& model, Index edge, const Configuration& here) {
  const SpatialEdge& framed = model.framed_edges[to_size(edge)];
  const FrameBlock block = FrameBlock::of(edge);
  return EdgeFrame(framed.vector(here.coordinates, here.controls), here.coordinates[framed.theta],
                   block.tangent(here.controls), block.director(here.controls))
      .frame;
}

}  // namespace der
