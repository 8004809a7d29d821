#include "der/lanes/member_frames.hpp"

#include "der/kinematics/edge_frame.hpp"
#include "der/model/frames.hpp"

namespace der {
namespace {

/// `value(model)` of each member, three numbers.
template <class T, class Value>
Vector3<T> each(const MemberModels<T>& models, const Value& value) {
  Vector3<T> result;
  for (int c = 0; c < 3; ++c) {
    result[c] = in_lanes<T>([&](int lane) { return Vec3(value(*models[to_size(lane)]))[c]; });
  }
  return result;
}

}  // namespace

template <class T>
MemberFrames<T>::MemberFrames(const MemberModel<T>& model) : model_(model) {
  const Model& structure = model.structure();
  for (std::size_t i = 0; i < structure.framed_edges.size(); ++i) {
    const SpatialEdge& edge = structure.framed_edges[i];
    const auto offset = [&](SpatialPivot SpatialEdge::* end) {
      return each<T>(model.models, [&](const Model& one) {
        return (one.framed_edges[i].*end).reference_offset();
      });
    };
    edges_.push_back({edge.start, edge.end, edge.theta, FrameBlock::of(static_cast<Index>(i)),
                      offset(&SpatialEdge::first), offset(&SpatialEdge::last)});
  }
  for (std::size_t i = 0; i < structure.framed_vertices.size(); ++i) {
    const FramedVertex& vertex = structure.framed_vertices[i];
    const auto axis = [&](Vec3 SectionFrame::* of) {
      return each<T>(model.models,
                     [&](const Model& one) { return one.framed_vertices[i].held.drawn.*of; });
    };
    vertices_.push_back(
        {vertex.before,
         vertex.after,
         vertex.twist(),
         {axis(&SectionFrame::tangent), axis(&SectionFrame::first), axis(&SectionFrame::second)}});
  }
}

/// `frame_turned_too_far`.
template <class T>
LaneSet MemberFrames<T>::turned_too_far(const MemberVector<T>& coordinates,
                                        const MemberVector<T>& frames) const {
  T is_far = 0.0;
  run_member_loop<T>([&] {
    for (const Edge& edge : edges_) {
      const T cosine = at(edge.block.first, frames).dot(vector(edge, coordinates));
      is_far += 1.0 - T::is_positive(cosine);
    }
  });
  return LaneSet::where(is_far);
}

/// `follow_frames`.
template <class T>
void MemberFrames<T>::follow(LaneSet lanes, const MemberVector<T>& coordinates,
                             MemberVector<T>& frames) const {
  const T is_taken = lanes.mask<T>();
  const auto take = [&](Index entry, const T& value) {
    frames[entry] = T::select(is_taken, value, frames[entry]);
  };
  run_member_loop<T>([&] {
    for (const Edge& edge : edges_) {
      const Index first = edge.block.first;
      const SectionFrameOf<T> moved =
          moved_frame<T>(at(first, frames), at(first + 3, frames), vector(edge, coordinates));
      for (int c = 0; c < 3; ++c) {
        take(first + c, moved.tangent[c]);
        take(first + 3 + c, moved.first[c]);
      }
    }
    for (const Vertex& vertex : vertices_) {
      const SectionFrameOf<T> before =
          vertex.before >= 0 ? reference_frame(vertex.before, frames) : vertex.held;
      const SectionFrameOf<T> after =
          vertex.after >= 0 ? reference_frame(vertex.after, frames) : vertex.held;
      take(vertex.twist, nearest_turn(twist_between<T>(before, after), frames[vertex.twist]));
    }
  });
}

#define DER_INSTANTIATE(T) template class MemberFrames<T>;
DER_FOR_MEMBER_LANES(DER_INSTANTIATE)
#undef DER_INSTANTIATE

}  // namespace der
