#pragma once

#include <vector>

#include "der/core/types.hpp"
#include "der/kinematics/configuration.hpp"
#include "der/model/model.hpp"

namespace der {

/// Edges of a rod in space whose sections are counted one from another, with the vertices between
/// them: from a clamp or a free end on to the next clamp or the other end, or around a ring. The
/// rods of a model without sections have none.
struct SectionChain {
  struct Link {
    Index before = -1;  ///< number of the edge in the model; -1: a clamp
    Index after = -1;   ///< number of the edge in the model; -1: a clamp
    Index twist = -1;   ///< entry of its reference twist among the frames
    const RodVertex* vertex = nullptr;
    const HeldFrame* held = nullptr;  ///< of the clamp, if there is one
    bool holds_section = true;        ///< whether that holds it against turning about the tangent

    [[nodiscard]] bool leaves_clamp() const { return before < 0; }
    [[nodiscard]] bool arrives() const { return after < 0; }
    /// The part of its twist strain [rad] that neither the angles of its edges nor the reference
    /// twist make.
    [[nodiscard]] double offset(const Vector& controls) const {
      if (held == nullptr) return -vertex->glued;
      const double turned = held->twist_angle(controls);
      return leaves_clamp() ? -turned : turned;
    }
  };
  const RodMesh* rod = nullptr;
  std::vector<Link> links;  ///< in the order of the arc length; at least one

  [[nodiscard]] Index first_edge() const {
    return links.front().leaves_clamp() ? links.front().after : links.front().before;
  }
  /// Whether its last vertex leads back to the first edge.
  [[nodiscard]] bool is_ring() const {
    return !links.front().leaves_clamp() && links.back().after == first_edge();
  }
  /// Whether its last vertex leads to a section that does not follow from those before: a clamp's,
  /// or that of the first edge of a ring.
  [[nodiscard]] bool has_end() const { return links.back().arrives() || is_ring(); }
  /// Whether a clamp holds the section before its first vertex, and behind its last one.
  [[nodiscard]] bool start_is_held() const {
    return links.front().leaves_clamp() && links.front().holds_section;
  }
  [[nodiscard]] bool end_is_held() const {
    return links.back().arrives() && links.back().holds_section;
  }
  /// Whether its sections cannot turn away a twist between its ends.
  [[nodiscard]] bool keeps_twist() const { return is_ring() || (start_is_held() && end_is_held()); }
};

/// All chains of a model.
std::vector<SectionChain> section_chains(const Model& model);

/// Sets the reference frames of all edges in chains (model/followed.hpp) to those that a shape
/// determines: the frame of a chain's first edge follows from the clamp before it, else from its
/// drawn frame by the smallest rotation, and each later one from that before. The vertices have the
/// reference twists of the drawn shape, but for that at the end of a chain, which stays as it is.
void lay_frames(const Model& model, const std::vector<SectionChain>& chains,
                const Configuration& here, Eigen::Ref<Vector> frames);

/// The sum of the reference twists [rad] of a chain that has an end, whole turns included.
struct ReferenceTurn {
  double turn = 0.0;       ///< of the values that the shape allows, the one nearest to the next
  double of_clamps = 0.0;  ///< what the clamps have turned about their drawn tangents
};

/// As the clamps of a chain have turned from the drawn shape while the rod followed them to the one
/// `here`, which tells it up to two turns.
ReferenceTurn reference_turn(const Model& model, const SectionChain& chain,
                             const Configuration& here);

}  // namespace der
