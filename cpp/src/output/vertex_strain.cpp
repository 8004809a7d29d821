#include "der/output/vertex_strain.hpp"

#include <cmath>
#include <utility>

#include "der/core/index.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/spatial_bend.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/energies/vertex_response.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/frames.hpp"
#include "der/model/internal_damping.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "output/actuated_shape.hpp"
#include "supports/leg_clamp.hpp"

namespace der {
namespace {

double rotation_of(const HeldFrame& held, const Model& model, const State& state) {
  return held.rotation < 0 ? 0.0 : control_value(model, state, held.rotation);
}

Vec3 offset(const SpatialPivot& pivot, const Model& model, const State& state) {
  if (pivot.distance == 0.0) return Vec3::Zero();
  return pivot.distance * held_frame(pivot.held, model, state).tangent;
}

Vec2 rate_of_offset(const Pivot& pivot, const Model& model, const State& state) {
  if (pivot.rotation < 0) return Vec2::Zero();
  const Vec2 offset = pivot.offset(control_value(model, state, pivot.rotation));
  return turn_rate(model, state, pivot.rotation) * perpendicular(offset);
}

Vec3 rate_of_offset(const SpatialPivot& pivot, const Model& model, const State& state) {
  if (pivot.distance == 0.0) return Vec3::Zero();
  return held_spin(pivot.held, model, state).cross(offset(pivot, model, state));
}

/// The section that the clamp of a vertex holds, on the vertex's leg.
HeldFrame held_at(const RodVertex& vertex, const RodMesh& rod, const Model& model) {
  return clamp_of_leg(rod.clamps[to_size(vertex.clamp)], vertex.before >= 0, rod, model).held;
}

/// The frames on both sides of a vertex, with the angle that the side after it is turned by against
/// the reference directors, less that of the side before it.
struct Sides {
  SectionFrame before;
  SectionFrame after;
  double turned = 0.0;
};

double theta(Index edge, const Model& model, const State& state) {
  return state.positions[model.framed_edges[to_size(edge)].theta];
}

Sides sides_of(const RodVertex& vertex, const RodMesh& rod, const Model& model,
               const State& state) {
  Sides sides;
  const auto clamped = [&](SectionFrame& frame, double sign) {
    const HeldFrame held = held_at(vertex, rod, model);
    const double twist = held.twist < 0 ? 0.0 : control_value(model, state, held.twist);
    frame = held_frame(held, model, state).turned(twist);
    sides.turned += sign * twist;
  };
  const auto on_edge = [&](Index edge, SectionFrame& frame, double sign) {
    const Index number = rod.first_edge + edge;
    frame = section_frame(model, number, state);
    sides.turned += sign * theta(number, model, state);
  };
  if (vertex.before >= 0) {
    on_edge(vertex.before, sides.before, -1.0);
  } else {
    clamped(sides.before, -1.0);
  }
  if (vertex.after >= 0) {
    on_edge(vertex.after, sides.after, 1.0);
  } else {
    clamped(sides.after, 1.0);
  }
  if (vertex.glued != 0.0) {
    sides.after = sides.after.turned(-vertex.glued);
    if (vertex.after >= 0) sides.turned -= vertex.glued;
  }
  return sides;
}

bool holds_section(const RodVertex& vertex, const RodMesh& rod) {
  return vertex.clamp < 0 || rod.clamps[to_size(vertex.clamp)].holds_section;
}

template <class Curvature>
VertexKinematics<Curvature> kinematics_of(const RodVertex& vertex, const RodMesh& rod,
                                          const Model& model, const State& state) {
  const Sides sides = sides_of(vertex, rod, model, state);
  const FrameBlock block =
      FrameBlock::of(rod.first_edge + (vertex.after >= 0 ? vertex.after : vertex.before));
  const Index entry = vertex.after >= 0 ? block.twist_at_start() : block.twist_at_end();
  const Index first = static_cast<Index>(model.followed_edges.size());
  const double twist = nearest_turn(twist_between(sides.before, sides.after),
                                    sides.turned + state.followed[first + entry]);
  if (holds_section(vertex, rod)) return {sides.before, sides.after, twist};
  return VertexKinematics<Curvature>::with_free_side(
      vertex.before < 0 ? FreeSide::Before : FreeSide::After, sides.before, sides.after, twist,
      rest_strain(vertex, rod, model, state).twist);
}

/// The stiffness of a corner, null if the vertex is none, and its viscosity.
struct CornerOf {
  const CoupledVertex* vertex = nullptr;
  Mat3 viscosity = Mat3::Zero();
};

CornerOf corner_of(const RodVertex& vertex, const RodMesh& rod, const Model& model) {
  if (vertex.before < 0 || vertex.after < 0) return {};
  const Index theta_before = model.framed_edges[to_size(rod.first_edge + vertex.before)].theta;
  const auto find = [&](const auto& list, const auto& vertex_of) {
    CornerOf corner;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (list.dofs[i][9] != theta_before) continue;
      corner.vertex = &vertex_of(list.constants[i]);
      for (const DampedElement& damped : list.damped) {
        if (damped.element == i) corner.viscosity = damped.viscosity;
      }
    }
    return corner;
  };
  using Plain = CornerBend::Constants;
  using BesideClamp = FromSpatialPivot<CornerBend>::Constants;
  const CornerOf plain =
      find(elements_of<CornerBend>(*model.elements),
           [](const Plain& element) -> const CoupledVertex& { return element.vertex; });
  if (plain.vertex != nullptr) return plain;
  return find(
      elements_of<FromSpatialPivot<CornerBend>>(*model.elements),
      [](const BesideClamp& element) -> const CoupledVertex& { return element.element.vertex; });
}

/// The rates of the strains of a vertex [1/s].
template <class Curvature>
Vec3 strain_rate(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                 const State& state) {
  const auto spin = [&](Index edge) -> Vec3 {
    if (edge < 0) return held_spin(held_at(vertex, rod, model), model, state);
    const SpatialEdge& own = model.framed_edges[to_size(rod.first_edge + edge)];
    const Vec3 vector = effective_vector(own, model, state);
    return vector.cross(effective_rate(own, model, state)) / vector.squaredNorm() +
           state.velocities[own.theta] * vector.normalized();
  };
  return by_rotation(kinematics_of<Curvature>(vertex, rod, model, state)) *
         (spin(vertex.after) - spin(vertex.before));
}

template <class Curvature>
MaterialCurvature viscous_part(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                               const State& state) {
  const Vec3 rates = strain_rate<Curvature>(vertex, rod, model, state);
  Vec3 part =
      Vec3(rod.damping.bending, rod.damping.bending, rod.damping.twisting).cwiseProduct(rates);
  if (const auto [corner, viscosity] = corner_of(vertex, rod, model); corner != nullptr) {
    part = corner->coefficients.ldlt().solve(viscosity * rates);
  }
  return {part[0], part[1], holds_section(vertex, rod) ? part[2] : 0.0};
}

template <class Curvature>
Vec3 response_of(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                 const State& state) {
  const bool twists = holds_section(vertex, rod);
  MaterialCurvature rest = rest_strain(vertex, rod, model, state);
  const MaterialCurvature viscous = viscous_strain(vertex, rod, model, state);
  rest = {rest.kappa_1 - viscous.kappa_1, rest.kappa_2 - viscous.kappa_2,
          rest.twist - viscous.twist};
  const auto kinematics = kinematics_of<Curvature>(vertex, rod, model, state);
  VertexResponse response;
  if (const CoupledVertex* corner = corner_of(vertex, rod, model).vertex) {
    CoupledVertex actuated = *corner;
    actuated.rest = rest;
    kinematics.template respond<false>(actuated, response);
  } else {
    kinematics.template respond<false>(
        Vertex{rod.EI_1 / vertex.bend_length, rod.EI_2 / vertex.bend_length,
               twists ? rod.GJ / vertex.twist_length : 0.0, rest},
        response);
  }
  return response.moment;
}

/// The edges or held tangents before and after a vertex.
std::pair<Vec3, Vec3> directions(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                                 const State& state) {
  const auto side = [&](Index edge) -> Vec3 {
    if (edge >= 0) return effective_vector(spatial_edge(rod, edge, model), model, state);
    return held_frame(held_at(vertex, rod, model), model, state).tangent;
  };
  return {side(vertex.before), side(vertex.after)};
}

/// Without frames.
template <class Curvature>
MaterialCurvature bend_strain(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                              const State& state) {
  const auto [before, after] = directions(vertex, rod, model, state);
  return {Curvature::of(std::atan2(before.cross(after).norm(), before.dot(after))).kappa, 0.0, 0.0};
}

template <class Curvature>
MaterialCurvature measured(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                           const State& state) {
  return model.has_sections() ? kinematics_of<Curvature>(vertex, rod, model, state).strain()
                              : bend_strain<Curvature>(vertex, rod, model, state);
}

/// Calls f with the measure of a rod's curvature.
template <class F>
auto with_measure(const RodMesh& rod, const F& f) {
  return rod.curvature == scenario::CurvatureMeasure::Angle ? f(AngleCurvature{})
                                                            : f(TangentCurvature{});
}

}  // namespace

SectionFrame held_frame(const HeldFrame& held, const Model& model, const State& state) {
  return held.rotation < 0 ? held.drawn : held.rotated(rotation_of(held, model, state));
}

SectionFrame section_frame(const Model& model, Index edge, const State& state) {
  return reference_frame(edge, state.followed.tail(model.initial_frames.size()))
      .turned(theta(edge, model, state));
}

Vector directors_of(const Model& model, const State& state) {
  const Configuration here = configuration_of(model, state);
  const auto edges = model.has_sections() ? static_cast<Index>(model.framed_edges.size()) : 0;
  Vector directors(3 * edges);
  for (Index edge = 0; edge < edges; ++edge) {
    directors.segment<3>(3 * edge) = section_frame(model, edge, here).first;
  }
  return directors;
}

MaterialCurvature rest_strain(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                              const State& state) {
  const ActuatedRest actuated(natural_strain_offset(rod, vertex), 3, model);
  const Vec3 change = actuated.strains(model, state);
  return {vertex.rest.kappa_1 + change[0], vertex.rest.kappa_2 + change[1],
          vertex.rest.twist + change[2]};
}

MaterialCurvature strain_of(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                            const State& state) {
  return with_measure(
      rod, [&](auto measure) { return measured<decltype(measure)>(vertex, rod, model, state); });
}

MaterialCurvature viscous_strain(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                                 const State& state) {
  if (!rod.damping.any() || !model.has_sections()) return {};
  return with_measure(rod, [&](auto measure) {
    return viscous_part<decltype(measure)>(vertex, rod, model, state);
  });
}

Vec3 moment_of(const RodVertex& vertex, const RodMesh& rod, const Model& model,
               const State& state) {
  return with_measure(
      rod, [&](auto measure) { return response_of<decltype(measure)>(vertex, rod, model, state); });
}

Vec3 cell_moment(const RodVertex& vertex, const RodMesh& rod, const Model& model,
                 const State& state) {
  if (model.has_sections()) return moment_of(vertex, rod, model, state);
  const auto [before, after] = directions(vertex, rod, model, state);
  const Vec3 axis = before.cross(after);
  const double angle = std::atan2(axis.norm(), before.dot(after));
  const CurvatureValue curvature = rod.curvature == scenario::CurvatureMeasure::Angle
                                       ? AngleCurvature::of(angle)
                                       : TangentCurvature::of(angle);
  const double moment = rod.EI_1 / vertex.bend_length * curvature.kappa * curvature.first;
  return moment * axis.normalized();
}

Vec3 bend_axis(const RodVertex& vertex, const RodMesh& rod, const Model& model,
               const State& state) {
  const auto [before, after] = directions(vertex, rod, model, state);
  return before.cross(after).normalized();
}

Vec3 effective_end(const SpatialEdge& edge, bool last, const Model& model, const State& state) {
  return state.positions.segment<3>(last ? edge.end : edge.start) +
         offset(last ? edge.last : edge.first, model, state);
}

Vec3 effective_vector(const SpatialEdge& edge, const Model& model, const State& state) {
  return effective_end(edge, true, model, state) - effective_end(edge, false, model, state);
}

Vec2 effective_rate(const EffectiveEdge& edge, const Model& model, const State& state) {
  const Vector& v = state.velocities;
  return Vec2(v[edge.dofs[2]], v[edge.dofs[3]]) - Vec2(v[edge.dofs[0]], v[edge.dofs[1]]) +
         rate_of_offset(edge.last, model, state) - rate_of_offset(edge.first, model, state);
}

Vec3 effective_rate(const SpatialEdge& edge, const Model& model, const State& state) {
  return state.velocities.segment<3>(edge.end) - state.velocities.segment<3>(edge.start) +
         rate_of_offset(edge.last, model, state) - rate_of_offset(edge.first, model, state);
}

Vec3 held_spin(const HeldFrame& held, const Model& model, const State& state) {
  Vec3 spin = Vec3::Zero();
  if (held.rotation >= 0) spin += turn_rate(model, state, held.rotation) * held.axis;
  if (held.twist >= 0) {
    spin += turn_rate(model, state, held.twist) * held_frame(held, model, state).tangent;
  }
  return spin;
}

}  // namespace der
