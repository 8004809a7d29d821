#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/kinematics/joint_turn.hpp"
#include "der/kinematics/section_frame.hpp"
#include "der/kinematics/spatial_edge.hpp"

namespace der {

struct Model;

/// The vertex between two edges with section frames, or between one and a clamp or a joint.
struct FramedVertex {
  Index before = -1;     ///< number of the edge; -1: a clamp or joint, before the edge `after`
  Index after = -1;      ///< number of the edge; -1: a clamp or joint
  HeldFrame held;        ///< of the clamp, if there is one
  Index rotation = -1;   ///< first degree of freedom of the joint's rotation, if there is one
  JointSection joint{};  ///< of the joint

  /// Entry of the reference twist.
  [[nodiscard]] Index twist() const {
    return after >= 0 ? FrameBlock::of(after).twist_at_start()
                      : FrameBlock::of(before).twist_at_end();
  }
};

/// The reference frame of an edge that has the unit tangent `source` and the reference director
/// `director`, moved to the present vector of the edge.
template <class T>
SectionFrameOf<T> moved_frame(const Vector3<T>& source, const Vector3<T>& director,
                              const Vector3<T>& vector) {
  const Vector3<T> tangent = unit_vector(vector);
  const Vector3<T> moved = transport<T>(director, source, tangent);
  return SectionFrameOf<T>::of(tangent, made_perpendicular<T>(moved, tangent));
}

/// Entries of the rotation of a joint, by the number of its first degree of freedom (DofMap).
JointBlock joint_block(const Model& model, Index rotation);

/// Moves the frames of all edges in `frames` to the shape at `coordinates`: parallel transport in
/// time of their reference directors, and reference twists that change by less than half a turn
/// (Bergou et al., Discrete Viscous Threads, SIGGRAPH 2010, section 4.2). `controls` turn the
/// clamps. The angles of the edges, the coordinates of joints and all energies stay as they are:
/// each joint enters its rotation as that from which it turns on.
void follow_frames(const Model& model, const Vector& coordinates, const Vector& controls,
                   Eigen::Ref<Vector> frames);

/// First degree of freedom of the end of an edge whose tangent has turned by more than a quarter
/// turn from its value in `frames`, or of the node of a joint that has; -1 if none has.
Index frame_turned_too_far(const Model& model, const Vector& coordinates, const Vector& controls,
                           const Eigen::Ref<const Vector>& frames);

/// The reference frame of an edge, from the blocks of all edges.
SectionFrame reference_frame(Index edge, const Eigen::Ref<const Vector>& frames);

/// The section frame of an edge in the initial shape.
SectionFrame initial_frame(const Model& model, Index edge);

/// The section frame of an edge in a configuration.
SectionFrame section_frame(const Model& model, Index edge, const Configuration& here);

}  // namespace der
