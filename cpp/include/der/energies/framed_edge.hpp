#pragma once

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/kinematics/edge_frame.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/kinematics/spatial_edge.hpp"

namespace der {

/// An edge with a section frame that a load follows, or turns.
struct FramedEdge {
  SpatialEdge edge;
  FrameBlock block;
  SectionFrame drawn;  ///< its frame in the initial shape

  [[nodiscard]] EdgeFrame frame(const Configuration& here) const {
    return {edge.vector(here.coordinates, here.controls), here.coordinates[edge.theta],
            block.tangent(here.controls), block.director(here.controls)};
  }
  /// A vector turned as the frame is from the initial shape.
  [[nodiscard]] Vec3 turned(const Vec3& vector, const SectionFrame& now) const {
    return drawn.tangent.dot(vector) * now.tangent + drawn.first.dot(vector) * now.first +
           drawn.second.dot(vector) * now.second;
  }
  /// The vector that is `vector` once it is turned.
  [[nodiscard]] Vec3 turned_back(const Vec3& vector, const SectionFrame& now) const {
    return now.tangent.dot(vector) * drawn.tangent + now.first.dot(vector) * drawn.first +
           now.second.dot(vector) * drawn.second;
  }
};

}  // namespace der
