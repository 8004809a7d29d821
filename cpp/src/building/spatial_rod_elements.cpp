#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "building/corner.hpp"
#include "building/spatial_rod_elements.hpp"
#include "der/core/index.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/isotropic_bend.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/stretch.hpp"
#include "der/model/frames.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/section_spring.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "energies/add_element.hpp"
#include "model/corner.hpp"
#include "model/corner_twist.hpp"
#include "model/curvature_jump.hpp"
#include "model/glue.hpp"
#include "model/legs.hpp"
#include "model/natural_twist.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

/// An effective edge from a pivot is shorter than its edge and stretches for all of it.
void add_stretch(const RodMesh& rod, const SpatialEdge& edge, Index number, Model& model) {
  const double whole = rod.edge_length[to_size(number)];
  const double length = edge.has_pivot() ? edge.drawn(model.reference_positions).norm() : whole;
  add_element<Stretch<3>>(
      {edge.start, edge.start + 1, edge.start + 2, edge.end, edge.end + 1, edge.end + 2},
      {rod.EA * (length / whole), length, rod.natural_strain_entries.edge(number)}, edge.first,
      edge.last, *model.elements);
}

Vertex stiffness_of(const RodMesh& rod, const RodVertex& vertex, bool holds_section) {
  return {rod.EI_1 / vertex.bend_length, rod.EI_2 / vertex.bend_length,
          holds_section ? rod.GJ / vertex.twist_length : 0.0, vertex.rest};
}

bool resists_everything(const Vertex& vertex) {
  return vertex.bend_1 > 0.0 && vertex.bend_2 > 0.0 && vertex.twist > 0.0;
}

RodVertex vertex_at_node(const RodMesh& rod, Index place) {
  RodVertex vertex;
  vertex.before = rod.edge_before(place);
  vertex.after = rod.edge_after(place);
  vertex.bend_place = rod.arc_length_at(place);
  vertex.bend_length = bend_length(rod, place);
  vertex.twist_place = 0.5 * (rod.edge_middle(place - 1) + rod.edge_middle(place));
  vertex.twist_length = rod.voronoi_length(place);
  return vertex;
}

/// The cell between a clamp at a place and the edge that leaves it, or arrives there.
RodVertex vertex_at_clamp(const RodMesh& rod, Index clamp, Index place, bool leaves) {
  const Index edge = leaves ? rod.edge_after(place) : rod.edge_before(place);
  const double length = rod.edge_length[to_size(edge)];
  const double ahead = leaves ? length : -length;
  RodVertex vertex;
  (leaves ? vertex.after : vertex.before) = edge;
  vertex.clamp = clamp;
  vertex.bend_place = rod.arc_length_at(place) + clamp_pivot_share() * ahead;
  vertex.bend_length = clamp_cell_length(rod, edge);
  vertex.twist_place = rod.arc_length_at(place) + 0.25 * ahead;
  vertex.twist_length = 0.5 * length;
  return vertex;
}

/// All vertices of a rod, from its start to its end.
std::vector<RodVertex> vertices_of(const RodMesh& rod) {
  std::vector<RodVertex> vertices;
  for (Index place = 0; place <= rod.num_edges(); ++place) {
    const Clamp* clamp = rod.clamp_at(place);
    // The two sides of a place; those of the first one of a ring are at its two ends.
    const bool arrives = place > 0;
    const bool leaves = place < rod.num_edges();
    if (clamp == nullptr) {
      if (arrives && rod.is_inner(place)) vertices.push_back(vertex_at_node(rod, place));
      continue;
    }
    const auto number = static_cast<Index>(clamp - rod.clamps.data());
    if (arrives) vertices.push_back(vertex_at_clamp(rod, number, place, false));
    if (leaves) vertices.push_back(vertex_at_clamp(rod, number, place, true));
  }
  return vertices;
}

/// Natural curvature, where the scene gives it, at a node as the edge after it has it, or the one
/// before it [1/m].
Vec2 natural_curvature_beside(const RodMesh& rod, Index place, bool after) {
  const Index edge = after ? rod.edge_after(place) : rod.edge_before(place);
  const SectionFrame& section = rod.initial_frames[to_size(edge)];
  const Vec3 bent =
      curvature_beyond_mean(rod, place, after, rod.natural_jumps).cross(section.tangent);
  return rod.natural_curvatures[to_size(rod.position(place))] +
         Vec2(bent.dot(section.first), bent.dot(section.second));
}

/// Natural curvature at a vertex, where the scene gives it [1/m].
Vec2 natural_curvature_at(const RodMesh& rod, const RodVertex& vertex) {
  if (vertex.clamp < 0) return rod.natural_curvatures[to_size(vertex.after)];
  const bool leaves = vertex.leaves_clamp();
  const Index edge = leaves ? vertex.after : vertex.before;
  const Vec2 first = natural_curvature_beside(rod, edge, true);
  const Vec2 last = natural_curvature_beside(rod, edge + 1, false);
  const double share = leaves ? clamp_pivot_share() : 1.0 - clamp_pivot_share();
  return (1.0 - share) * first + share * last;
}

/// A free end lies on the curve, the node next to it l^2 kappa/12 beside it (supports/clamp.hpp):
/// by how much the natural turning angle there is larger.
Vec2 free_end_turn(const RodMesh& rod, const RodVertex& vertex) {
  Vec2 turn = Vec2::Zero();
  if (vertex.clamp >= 0 || rod.closed) return turn;
  const auto add = [&](Index end, Index edge) {
    if (rod.clamp_at(end) != nullptr) return;
    turn += rod.edge_length[to_size(edge)] / 12.0 * rod.natural_curvatures[to_size(end)];
  };
  if (vertex.before == 0) add(0, 0);
  if (vertex.after == rod.num_edges() - 1) add(rod.num_edges(), vertex.after);
  return turn;
}

/// Natural curvature, in the section before a vertex, of the cell about it [1/m]: half of the cell
/// lies beyond the vertex, where the sections of a ring may be glued turned.
Vec2 mean_natural_curvature(const RodMesh& rod, const RodVertex& vertex) {
  if (vertex.clamp >= 0 || vertex.glued == 0.0) return vertex.natural_curvature;
  const double before = rod.edge_length[to_size(vertex.before)];
  const double after = rod.edge_length[to_size(vertex.after)];
  const Vec2 beyond = Eigen::Rotation2Dd(vertex.glued) * vertex.natural_curvature;
  return (before * vertex.natural_curvature + after * beyond) / (before + after);
}

/// Adds a twist [rad/m] to the rest shape of a vertex: each half of its cell turns about its own
/// tangent.
void add_twist(const RodMesh& rod, double twist, RodVertex& vertex) {
  if (vertex.clamp >= 0) {
    vertex.rest.twist += twist * vertex.twist_length;
    return;
  }
  const CellHalves halves = rod.cell_halves_at(vertex.place());
  const Vec3 strain = 0.5 * twist *
                      (rod.edge_length[to_size(vertex.before)] * halves.before.col(2) +
                       rod.edge_length[to_size(vertex.after)] * halves.after.col(2));
  vertex.rest.kappa_1 += strain[0];
  vertex.rest.kappa_2 += strain[1];
  vertex.rest.twist += strain[2];
}

void set_rest(const RodMesh& rod, const MaterialCurvature& drawn, RodVertex& vertex) {
  vertex.rest = drawn;
  vertex.natural_curvature = Vec2(drawn.kappa_1, drawn.kappa_2) / vertex.bend_length;
  if (!rod.natural_curvatures.empty()) {
    vertex.natural_curvature = natural_curvature_at(rod, vertex);
    const Vec2 turn =
        vertex.bend_length * mean_natural_curvature(rod, vertex) + free_end_turn(rod, vertex);
    vertex.rest.kappa_1 = turn[0];
    vertex.rest.kappa_2 = turn[1];
  }
  if (!rod.natural_twist.empty()) {
    add_twist(rod, natural_twist_at(rod, vertex) - rod.initial_twist, vertex);
  }
}

/// Angle [rad] by which the section `after` was turned when it was glued to the one `before`, in
/// (-pi, pi]: what is between them besides their `twist`.
double glued_angle(const SectionFrame& before, const SectionFrame& after, double twist) {
  return nearest_turn(twist_between(before, after) - twist, 0.0);
}

/// A vertex between two frames that are drawn with `twist` between them.
template <class Curvature>
VertexKinematics<Curvature> reference_vertex(const SectionFrame& before, const SectionFrame& after,
                                             double twist) {
  return {before, after, nearest_turn(twist_between(before, after), twist)};
}

/// Curvature [1/m] of the drawn rod about a place at which edges meet, on the side of `edge`, one
/// of the two, where sections are glued turned; and where it has this value, in the section there:
/// a third of the edges' difference beside the place. The mean of the edges' sections is that a
/// quarter of it beside.
std::pair<double, Vec2> reference_curvature(const RodMesh& rod, Index place, Index edge) {
  const Index before = rod.edge_before(place);
  const Index after = rod.edge_after(place);
  const double twist = rod.voronoi_length(place) * rod.initial_twist;
  SectionFrame a = rod.initial_frames[to_size(before)];
  SectionFrame b = rod.initial_frames[to_size(after)];
  if (after == 0) {
    const double glued = glued_angle(a, b, twist);
    if (edge == after) {
      a = a.turned(glued);
    } else {
      b = b.turned(-glued);
    }
  }
  const MaterialCurvature drawn = reference_vertex<AngleCurvature>(a, b, twist).strain();
  const double longer = rod.edge_length[to_size(after)] - rod.edge_length[to_size(before)];
  const Eigen::Rotation2Dd in_section(-(1.0 / 3.0 - 0.25) * longer * rod.initial_twist);
  return {rod.arc_length_at(place) + longer / 3.0,
          in_section * Vec2(drawn.kappa_1, drawn.kappa_2) / rod.voronoi_length(place)};
}

/// Curvature [1/m] of the drawn rod at a node, in the section there, on the side before it where
/// sections are glued turned: on the line through its value and that of a neighbour on its leg.
Vec2 reference_curvature_at_node(const RodMesh& rod, Index place,
                                 const std::vector<Index>& bounds) {
  const auto [own_place, own] = reference_curvature(rod, place, rod.edge_before(place));
  const double missing = rod.arc_length_at(place) - own_place;
  const auto is_bound = [&](Index other) {
    return std::binary_search(bounds.begin(), bounds.end(), rod.position(other));
  };
  if (std::abs(missing) <= rod.same_place() || is_bound(place)) return own;
  for (const Index other : {place - 1, place + 1}) {
    const bool is_beyond_glue = other > place && rod.position(place) == 0;
    if (is_beyond_glue || !rod.is_inner(other) || is_bound(other)) continue;
    if (rod.clamp_at(other) != nullptr) continue;  // the shape may have a kink there
    const Index edge = other < place ? rod.edge_after(other) : rod.edge_before(other);
    const auto [other_place, value] = reference_curvature(rod, other, edge);
    return own + missing / (other_place - own_place) * (value - own);
  }
  return own;
}

/// Curvature [1/m] of the drawn rod where it bends beside a clamp: on the line through those at the
/// two nodes beyond it. The turn of the cell itself does not tell it, nor that at the next node:
/// the effective edge between, a chord from a pivot on the tangent, leans further than the curve.
/// Corners are no part of the curve.
Vec2 reference_curvature_at_clamp(const RodMesh& rod, const RodVertex& vertex, const Model& model) {
  const bool leaves = vertex.after >= 0;
  const Index edge = leaves ? vertex.after : vertex.before;
  const Index held = leaves ? edge : edge + 1;
  const Index near = leaves ? edge + 1 : edge;
  const auto has_value = [&](Index place) {
    return 0 <= place && place <= rod.num_edges() && rod.is_inner(place) &&
           !is_corner(rod, place, model);
  };
  if (!has_value(near))
    return has_value(held) ? reference_curvature(rod, held, edge).second : Vec2(Vec2::Zero());
  const auto [s, value] = reference_curvature(rod, near, edge);
  // The shape may have a kink at the clamp: the line is that on this side of it.
  Index far = 2 * near - held;
  if (!has_value(far) || rod.clamp_at(near) != nullptr) far = held;
  if (!has_value(far)) return value;
  const auto [other_s, other] = reference_curvature(rod, far, edge);
  const double share = (vertex.bend_place - s) / (other_s - s);
  return (1.0 - share) * value + share * other;
}

/// Makes the elements of a rod whose sections count.
template <class Curvature>
class SectionElements {
 public:
  SectionElements(RodMesh& rod, Model& model)
      : rod_(rod), model_(model), bounds_(leg_bounds(rod, model)) {}

  void add() {
    for (RodVertex& vertex : rod_.vertices) {
      if (vertex.clamp < 0) {
        add_vertex(vertex);
      } else {
        add_clamp(vertex);
      }
    }
  }

 private:
  [[nodiscard]] Index number(Index edge) const { return rod_.first_edge + edge; }
  [[nodiscard]] const SpatialEdge& edge(Index edge) const {
    return model_.framed_edges[to_size(number(edge))];
  }
  [[nodiscard]] SectionFrame frame(Index edge) const { return initial_frame(model_, number(edge)); }
  [[nodiscard]] double theta(Index edge) const {
    return model_.reference_positions[this->edge(edge).theta];
  }

  /// Whether the two ends of a ring meet at a vertex.
  [[nodiscard]] bool closes_ring(const RodVertex& vertex) const {
    const bool at_last_edge = rod_.closed && vertex.before == rod_.num_edges() - 1;
    return at_last_edge && (vertex.clamp < 0 || rod_.clamps[to_size(vertex.clamp)].place == 0);
  }

  /// Enters a vertex with its reference twist, which is what the drawn frames have between them.
  void follow(const FramedVertex& vertex, double reference) {
    model_.framed_vertices.push_back(vertex);
    model_.initial_frames[vertex.twist()] = reference;
  }

  void add_vertex(RodVertex& vertex) {
    const SectionFrame a = frame(vertex.before);
    SectionFrame b = frame(vertex.after);
    double turned = theta(vertex.after) - theta(vertex.before);
    const double reference_twist_of_shape =
        vertex.twist_length * rod_.initial_twist + corner_twist(rod_, vertex.place(), model_);
    if (closes_ring(vertex)) {
      vertex.glued = glued_angle(a, b, reference_twist_of_shape);
      b = b.turned(-vertex.glued);
      turned -= vertex.glued;
    }
    const auto drawn = reference_vertex<Curvature>(a, b, reference_twist_of_shape);
    if (is_glued_turned(vertex) || is_corner(rod_, vertex.place(), model_)) {
      rod_.cell_halves.push_back(
          cell_halves(rod_.position(vertex.place()), a, frame(vertex.after), drawn));
    }
    set_rest(rod_, drawn.strain(), vertex);
    if (rod_.natural_curvatures.empty()) {
      vertex.natural_curvature = reference_curvature_at_node(rod_, vertex.place(), bounds_);
    }
    Vertex stiffness = stiffness_of(rod_, vertex, true);
    if constexpr (std::is_same_v<Curvature, AngleCurvature>) {
      if (has_two_halves(vertex) && resists_everything(stiffness)) {
        const double length = rod_.edge_length[to_size(vertex.before)];
        const double share = length / (length + rod_.edge_length[to_size(vertex.after)]);
        const CoupledVertex corner = corner_vertex(a, frame(vertex.after), drawn, share, stiffness);
        add_vertex_element<CornerBend>(vertex, corner);
        if (rod_.damping.any()) {
          damp_corner(vertex, corner_viscosity(corner, a, frame(vertex.after), drawn, share,
                                               stiffness, rod_.damping));
        }
        stiffness = {};  // the edges stay a chain (assembly/spatial_chain.hpp)
      }
    }
    add_vertex_element<SpatialBend<Curvature>>(vertex, stiffness);
    follow({number(vertex.before), number(vertex.after), {}}, drawn.strain().twist - turned);
  }

  /// Whether the cell about a vertex bends or twists about other axes before the node than after
  /// it: at a corner, and where sections of unequal stiffness are glued turned. Half a turn is
  /// none.
  [[nodiscard]] bool has_two_halves(const RodVertex& vertex) const {
    return turns_axes(vertex, rod_) || is_corner(rod_, vertex.place(), model_);
  }

  template <class Kernel, class AVertex>
  void add_vertex_element(const RodVertex& vertex, const AVertex& stiffness) {
    const SpatialEdge& before = edge(vertex.before);
    const SpatialEdge& after = edge(vertex.after);
    add_element<Kernel>(
        {before.start, before.start + 1, before.start + 2, after.start, after.start + 1,
         after.start + 2, after.end, after.end + 1, after.end + 2, before.theta, after.theta},
        {stiffness, FrameBlock::of(number(vertex.before)), FrameBlock::of(number(vertex.after)),
         vertex.glued, natural_strain_offset(rod_, vertex)},
        before.first, after.last, *model_.elements);
  }

  /// Of the vertex that was added last.
  void damp_corner(const RodVertex& vertex, const Mat3& viscosity) {
    const auto damp = [&](auto& list) { list.damped.push_back({list.size() - 1, viscosity}); };
    if (edge(vertex.before).first.distance == 0.0 && edge(vertex.after).last.distance == 0.0) {
      damp(elements_of<CornerBend>(*model_.elements));
    } else {
      damp(elements_of<FromSpatialPivot<CornerBend>>(*model_.elements));
    }
  }

  void add_clamp(RodVertex& vertex) {
    const Clamp& clamp = rod_.clamps[to_size(vertex.clamp)];
    const bool leaves = vertex.after >= 0;
    const Index beside = leaves ? vertex.after : vertex.before;
    const SpatialEdge& own = edge(beside);
    const double turned = leaves ? theta(beside) : -theta(beside);
    const SectionFrame frame_of_edge = frame(beside);
    HeldFrame held_frame = clamp_of_leg(clamp, !leaves, rod_, model_).held;
    SectionFrame& held = held_frame.drawn;
    const double beyond = vertex.twist_length * rod_.initial_twist;
    if (closes_ring(vertex)) {
      vertex.glued = glued_angle(frame_of_edge, held, beyond);
      held = held.turned(-vertex.glued);
    }
    const SectionFrame& a = leaves ? held : frame_of_edge;
    const SectionFrame& b = leaves ? frame_of_edge : held;
    const MaterialCurvature drawn = reference_vertex<Curvature>(a, b, beyond).strain();
    set_rest(rod_, drawn, vertex);
    if (rod_.natural_curvatures.empty()) {
      vertex.natural_curvature = reference_curvature_at_clamp(rod_, vertex, model_);
    }
    elements_of<FromSpatialPivot<SpatialClamp<Curvature>>>(*model_.elements)
        .add(
            {own.start, own.start + 1, own.start + 2, own.end, own.end + 1, own.end + 2, own.theta},
            {{stiffness_of(rod_, vertex, clamp.holds_section), held_frame,
              FrameBlock::of(number(beside)), leaves ? 1.0 : -1.0,
              natural_strain_offset(rod_, vertex), clamp.holds_section},
             own.first,
             own.last});
    follow({leaves ? -1 : number(beside), leaves ? number(beside) : -1, held_frame},
           drawn.twist - turned);
  }

  RodMesh& rod_;
  Model& model_;
  std::vector<Index> bounds_;  // of legs
};

/// Bending of a rod whose sections do not count.
template <class Curvature>
void add_isotropic_bending(const RodMesh& rod, Model& model) {
  for (const RodVertex& vertex : rod.vertices) {
    const double stiffness = rod.EI_1 / vertex.bend_length;
    if (vertex.clamp < 0) {
      const SpatialEdge before = spatial_edge(rod, vertex.before, model);
      const SpatialEdge after = spatial_edge(rod, vertex.after, model);
      add_element<IsotropicBend<Curvature>>(
          {before.start, before.start + 1, before.start + 2, after.start, after.start + 1,
           after.start + 2, after.end, after.end + 1, after.end + 2},
          {stiffness}, before.first, after.last, *model.elements);
    } else {
      const Index edge = vertex.after >= 0 ? vertex.after : vertex.before;
      const SpatialEdge own = spatial_edge(rod, edge, model);
      const Clamp& whole = rod.clamps[to_size(vertex.clamp)];
      const Clamp clamp = clamp_of_leg(whole, vertex.before >= 0, rod, model);
      elements_of<FromSpatialPivot<IsotropicClamp<Curvature>>>(*model.elements)
          .add({own.start, own.start + 1, own.start + 2, own.end, own.end + 1, own.end + 2},
               {{stiffness, clamp.held}, own.first, own.last});
    }
  }
}

template <class Curvature>
void add_bending(RodMesh& rod, Model& model) {
  if (model.has_sections()) {
    SectionElements<Curvature>(rod, model).add();
  } else {
    add_isotropic_bending<Curvature>(rod, model);
  }
}

}  // namespace

void draw_frames(const RodMesh& rod, Model& model) {
  for (Index i = 0; i < rod.num_edges(); ++i) {
    const SpatialEdge edge = spatial_edge(rod, i, model);
    const SectionFrame& drawn = rod.initial_frames[to_size(i)];
    const double theta = rod.initial_twist * rod.edge_middle(i);
    const Vec3 tangent = edge.drawn(model.reference_positions).normalized();
    const Vec3 director = transport(drawn.turned(-theta).first, drawn.tangent, tangent);
    const FrameBlock block = FrameBlock::of(rod.first_edge + i);
    model.initial_frames.segment<3>(block.first) = tangent;
    model.initial_frames.segment<3>(block.first + 3) = made_perpendicular(director, tangent);
    model.reference_positions[edge.theta] = theta;
    model.framed_edges.push_back(edge);
  }
}

void hold_angles(const RodMesh& rod, Model& model) {
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    model.held.push_back({model.dofs.angle(rod.first_edge + edge), -1});
  }
}

void add_spatial_rod_elements(RodMesh& rod, Model& model) {
  if (model.has_sections()) draw_frames(rod, model);
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    add_stretch(rod, spatial_edge(rod, edge, model), edge, model);
  }
  const bool bends = rod.EI_1 > 0.0 || rod.EI_2 > 0.0;
  if (bends) rod.vertices = vertices_of(rod);
  if (rod.vertices.empty() && rod.section_springs.empty()) {
    if (model.has_sections()) hold_angles(rod, model);
    return;
  }
  if (rod.curvature == scenario::CurvatureMeasure::Angle) {
    add_bending<AngleCurvature>(rod, model);
  } else {
    add_bending<TangentCurvature>(rod, model);
  }
  if (model.has_sections()) add_section_springs(rod, model);
}

}  // namespace der
