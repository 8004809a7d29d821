#pragma once

#include <vector>

#include "der/kinematics/frame_block.hpp"
#include "der/kinematics/section_frame.hpp"
#include "der/lanes/lane_set.hpp"
#include "der/lanes/member_model.hpp"
#include "der/model/spin.hpp"

namespace der {

/// The section frames of edges of several members (model/frames.hpp), and what spinning sections do
/// to the forces on their nodes (model/spin.hpp). There are none, at no cost, where sections do not
/// count. Vectors `frames` have the blocks of all edges (FrameBlock). No clamp turns.
template <class T>
class MemberFrames {
 public:
  explicit MemberFrames(const MemberModel<T>& model);

  [[nodiscard]] bool empty() const { return edges_.empty(); }
  /// The members of which an edge has turned by more than a quarter turn from its frame.
  [[nodiscard]] LaneSet turned_too_far(const MemberVector<T>& coordinates,
                                       const MemberVector<T>& frames) const;
  /// Moves the frames of the members in `lanes` to the shapes at `coordinates`.
  void follow(LaneSet lanes, const MemberVector<T>& coordinates, MemberVector<T>& frames) const;

  // For loops over members (`run_member_loop`).

  /// Takes the spin forces of a motion from `forces`, the elastic ones, at the rates
  /// `velocity(dof)`.
  template <class Velocity>
  void take_spin_forces(const MemberVector<T>& coordinates, const MemberVector<T>& frames,
                        const Velocity& velocity, MemberVector<T>& forces) const {
    take_pairs(coordinates, forces, [&](const Edge& edge, const Vector3<T>& vector) -> Vector3<T> {
      return transport_force_of(edge, vector, frames, forces) + gyroscopic(edge, vector, velocity);
    });
  }
  /// Takes from `forces` what the transport of frames has in them alone.
  void take_transport(const MemberVector<T>& coordinates, const MemberVector<T>& frames,
                      MemberVector<T>& forces) const {
    take_pairs(coordinates, forces, [&](const Edge& edge, const Vector3<T>& vector) {
      return transport_force_of(edge, vector, frames, forces);
    });
  }
  /// Adds the gyroscopic forces to `forces`.
  template <class Velocity>
  void add_gyroscopic(const MemberVector<T>& coordinates, const Velocity& velocity,
                      MemberVector<T>& forces) const {
    take_pairs(coordinates, forces, [&](const Edge& edge, const Vector3<T>& vector) -> Vector3<T> {
      return -gyroscopic(edge, vector, velocity);
    });
  }

 private:
  struct Edge {
    Index start;
    Index end;
    Index theta;
    FrameBlock block;
    Vector3<T> first;  ///< offset of a pivot from its node [m]
    Vector3<T> last;
  };
  /// A clamp holds the section that is drawn.
  struct Vertex {
    Index before;  ///< number of the edge; -1: the clamp
    Index after;
    Index twist;  ///< entry of the reference twist
    SectionFrameOf<T> held;
  };

  static Vector3<T> at(Index first, const MemberVector<T>& values) {
    return {values[first], values[first + 1], values[first + 2]};
  }
  static Vector3<T> vector(const Edge& edge, const MemberVector<T>& coordinates) {
    return at(edge.end, coordinates) + edge.last - at(edge.start, coordinates) - edge.first;
  }
  [[nodiscard]] SectionFrameOf<T> reference_frame(Index edge, const MemberVector<T>& frames) const {
    const Index first = edges_[to_size(edge)].block.first;
    return SectionFrameOf<T>::of(at(first, frames), at(first + 3, frames));
  }

  static Vector3<T> transport_force_of(const Edge& edge, const Vector3<T>& vector,
                                       const MemberVector<T>& frames,
                                       const MemberVector<T>& forces) {
    return transport_force<T>(vector, at(edge.block.first, frames), forces[edge.theta]);
  }
  template <class Velocity>
  Vector3<T> gyroscopic(const Edge& edge, const Vector3<T>& vector,
                        const Velocity& velocity) const {
    Vector3<T> rate;
    for (int c = 0; c < 3; ++c) rate[c] = velocity(edge.end + c) - velocity(edge.start + c);
    const T spin = model_.lumped[edge.theta] * velocity(edge.theta);
    return gyroscopic_force<T>(vector, rate, spin);
  }
  template <class Force>
  void take_pairs(const MemberVector<T>& coordinates, MemberVector<T>& forces,
                  const Force& force) const {
    for (const Edge& edge : edges_) {
      const Vector3<T> pair = force(edge, vector(edge, coordinates));
      for (int c = 0; c < 3; ++c) {
        forces[edge.start + c] += pair[c];
        forces[edge.end + c] -= pair[c];
      }
    }
  }

  const MemberModel<T>& model_;
  std::vector<Edge> edges_;
  std::vector<Vertex> vertices_;
};

}  // namespace der
