#include "der/supports/section_chain.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "der/core/index.hpp"
#include "der/kinematics/frame_block.hpp"
#include "der/model/frames.hpp"

namespace der {
namespace {

using Link = SectionChain::Link;

/// Framed vertices by the entries of their reference twists.
std::vector<const FramedVertex*> vertices_by_twist(const Model& model) {
  std::vector<const FramedVertex*> found(static_cast<std::size_t>(model.initial_frames.size()),
                                         nullptr);
  for (const FramedVertex& vertex : model.framed_vertices) {
    found[to_size(vertex.twist())] = &vertex;
  }
  return found;
}

/// The vertices of a rod in the order in which chains have them: a ring with clamps begins at one.
std::vector<const RodVertex*> ordered_vertices(const RodMesh& rod) {
  std::vector<const RodVertex*> order;
  for (const RodVertex& vertex : rod.vertices) order.push_back(&vertex);
  if (!rod.closed) return order;
  const auto first = std::find_if(order.begin(), order.end(),
                                  [](const RodVertex* vertex) { return vertex->leaves_clamp(); });
  if (first != order.end()) std::rotate(order.begin(), first, order.end());
  return order;
}

Vec3 drawn_tangent(Index edge, const Model& model) {
  return FrameBlock::of(edge).tangent(model.initial_frames);
}

Vec3 present_tangent(Index edge, const Model& model, const Configuration& here) {
  return model.framed_edges[to_size(edge)].vector(here.coordinates, here.controls).normalized();
}

SectionFrame frame_along(const Vec3& from, const Vec3& director, const Vec3& tangent) {
  constexpr double kOpposite = 1e-9;
  const Vec3 moved = 1.0 + from.dot(tangent) > kOpposite
                         ? Vec3(transport(director, from, tangent))
                         : director;  // half a turn about the director
  return SectionFrame::of(tangent, made_perpendicular(moved, tangent));
}

void set_frame(const SectionFrame& frame, Index edge, Eigen::Ref<Vector> frames) {
  const Index first = FrameBlock::of(edge).first;
  frames.segment<3>(first) = frame.tangent;
  frames.segment<3>(first + 3) = frame.first;
}

/// A rotation by a path, as a unit quaternion: two paths that differ by a turn have opposite ones.
using Path = Eigen::Quaterniond;

Path path_about(const Vec3& axis, double angle) { return Path(Eigen::AngleAxisd(angle, axis)); }

/// The smallest rotations from tangent to tangent along a chain, one after another.
template <class TangentOf>
Path path_along(const SectionChain& chain, const Vec3& start, const Vec3& end,
                const TangentOf& tangent_of) {
  Path path = Path::Identity();
  Vec3 before = start;
  for (const Link& link : chain.links) {
    const bool last = &link == &chain.links.back();
    const Vec3 after = last ? end : tangent_of(link.after);
    path = Path::FromTwoVectors(before, after) * path;
    before = after;
  }
  return path;
}

/// How one end of a chain has been moved from where it is drawn.
struct EndMotion {
  Vec3 drawn;          // tangent
  Vec3 present;        // likewise
  Path path;           // from one to the other
  double about = 0.0;  // of that about the drawn tangent [rad]
};

EndMotion motion_of_clamp(const HeldFrame& held, const Vector& controls) {
  const double angle = held.rotation < 0 ? 0.0 : controls[held.rotation];
  return {held.drawn.tangent, held.tangent(controls), path_about(held.axis, angle),
          angle * held.axis.dot(held.drawn.tangent)};
}

EndMotion motion_of_edge(Index edge, const Model& model, const Configuration& here) {
  const Vec3 drawn = drawn_tangent(edge, model);
  const Vec3 present = present_tangent(edge, model, here);
  return {drawn, present, Path::FromTwoVectors(drawn, present), 0.0};
}

}  // namespace

std::vector<SectionChain> section_chains(const Model& model) {
  std::vector<SectionChain> chains;
  if (model.framed_edges.empty()) return chains;
  const std::vector<const FramedVertex*> framed = vertices_by_twist(model);
  for (const RodMesh& rod : model.rods) {
    const std::size_t first_of_rod = chains.size();
    for (const RodVertex* vertex : ordered_vertices(rod)) {
      Link link;
      if (vertex->before >= 0) link.before = rod.first_edge + vertex->before;
      if (vertex->after >= 0) link.after = rod.first_edge + rod.position(vertex->after);
      link.twist = FramedVertex{link.before, link.after, {}}.twist();
      link.vertex = vertex;
      if (vertex->clamp >= 0) {
        link.held = &framed[to_size(link.twist)]->held;
        link.holds_section = rod.clamps[to_size(vertex->clamp)].holds_section;
      }
      if (link.leaves_clamp() || chains.size() == first_of_rod) chains.push_back({&rod, {}});
      chains.back().links.push_back(link);
    }
  }
  return chains;
}

void lay_frames(const Model& model, const std::vector<SectionChain>& chains,
                const Configuration& here, Eigen::Ref<Vector> frames) {
  for (const SectionChain& chain : chains) {
    SectionFrame last;
    if (chain.links.front().leaves_clamp()) {
      last = chain.links.front().held->untwisted(here.controls);
    } else {
      const Index edge = chain.first_edge();
      last = frame_along(drawn_tangent(edge, model),
                         FrameBlock::of(edge).director(model.initial_frames),
                         present_tangent(edge, model, here));
      set_frame(last, edge, frames);
    }
    for (const Link& link : chain.links) {
      if (&link == &chain.links.back() && chain.has_end()) break;
      const double twist = model.initial_frames[link.twist];
      last = frame_along(last.tangent, last.first, present_tangent(link.after, model, here))
                 .turned(twist);
      set_frame(last, link.after, frames);
      frames[link.twist] = twist;
    }
  }
}

ReferenceTurn reference_turn(const Model& model, const SectionChain& chain,
                             const Configuration& here) {
  const Link& first = chain.links.front();
  const Link& last = chain.links.back();
  const EndMotion start = first.leaves_clamp() ? motion_of_clamp(*first.held, here.controls)
                                               : motion_of_edge(chain.first_edge(), model, here);
  const EndMotion end = last.arrives() ? motion_of_clamp(*last.held, here.controls) : start;
  double drawn_turn = 0.0;
  for (const Link& link : chain.links) drawn_turn += model.initial_frames[link.twist];
  const Path drawn = path_along(chain, start.drawn, end.drawn,
                                [&](Index edge) { return drawn_tangent(edge, model); });
  const Path present = path_along(chain, start.present, end.present,
                                  [&](Index edge) { return present_tangent(edge, model, here); });
  // As an unbroken motion keeps it: turn * present * start = end * drawn turn * drawn.
  const Path turn =
      end.path * path_about(end.drawn, drawn_turn) * drawn * (present * start.path).conjugate();
  const double half = std::atan2(turn.vec().dot(end.present), turn.w());
  const double of_clamps = drawn_turn + end.about - start.about;
  return {2.0 * nearest_turn(half, 0.5 * of_clamps), of_clamps};
}

}  // namespace der
