#include "der/model/frames.hpp"

#include <utility>

#include "der/core/constants.hpp"
#include "der/core/index.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/model/model.hpp"

namespace der {

SectionFrame reference_frame(Index edge, const Eigen::Ref<const Vector>& frames) {
  const FrameBlock block = FrameBlock::of(edge);
  return SectionFrame::of(block.tangent(frames), block.director(frames));
}

JointBlock joint_block(const Model& model, Index rotation) {
  return {FrameBlock::kSize * model.dofs.num_angles() + JointBlock::kSize * (rotation / 3)};
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
  // The section of a vertex at one of its sides, and what a joint there has turned by about it.
  const auto side = [&](Index edge, const FramedVertex& vertex) -> std::pair<SectionFrame, double> {
    if (edge >= 0) return {reference_frame(edge, frames), 0.0};
    if (vertex.rotation < 0) return {vertex.held.untwisted(controls), 0.0};
    const JointTurn turn(vertex.joint.joint, frames, coordinates.segment<3>(vertex.rotation));
    const SectionFrame section = turn.section(vertex.joint.drawn);
    return {section, turn.delta().dot(section.tangent)};
  };
  for (const FramedVertex& vertex : model.framed_vertices) {
    const auto [before, turned_before] = side(vertex.before, vertex);
    const auto [after, turned_after] = side(vertex.after, vertex);
    double& twist = frames[vertex.twist()];
    twist = nearest_turn(twist_between(before, after), twist + turned_after - turned_before);
  }
  if (model.dimension != 3) return;
  for (Index rotation = 0; rotation < model.dofs.num_rotations(); rotation += 3) {
    const JointBlock block = joint_block(model, rotation);
    const Vec3 now = coordinates.segment<3>(model.dofs.rotation(rotation));
    const Vec3 delta = now - block.coordinates(frames);
    if (delta.isZero(0.0)) continue;
    const Eigen::Quaterniond turned = (rotation_by(delta) * block.rotation(frames)).normalized();
    frames.segment<3>(block.first) = now;
    frames.segment<4>(block.first + 3) << turned.w(), turned.vec();
  }
}

Index frame_turned_too_far(const Model& model, const Vector& coordinates, const Vector& controls,
                           const Eigen::Ref<const Vector>& frames) {
  for (Index edge = 0; edge < static_cast<Index>(model.framed_edges.size()); ++edge) {
    const Vec3 vector = model.framed_edges[to_size(edge)].vector(coordinates, controls);
    if (FrameBlock::of(edge).tangent(frames).dot(vector) < 0.0) {
      return model.framed_edges[to_size(edge)].end;
    }
  }
  for (Index rotation = 0; model.dimension == 3 && rotation < model.dofs.num_rotations();
       rotation += 3) {
    const Index dof = model.dofs.rotation(rotation);
    const Vec3 before = joint_block(model, rotation).coordinates(frames);
    if ((coordinates.segment<3>(dof) - before).norm() > 0.5 * kPi) {
      return model.dof(model.dofs.node_of(dof), 0);
    }
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
