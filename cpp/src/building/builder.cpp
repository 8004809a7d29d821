#include "der/building/builder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "building/actuation.hpp"
#include "building/force_nodes.hpp"
#include "building/joints.hpp"
#include "building/leg_elements.hpp"
#include "building/load_variation.hpp"
#include "building/spatial_leg_elements.hpp"
#include "building/spatial_rod_elements.hpp"
#include "der/building/rod_elements.hpp"
#include "der/catalog/quantities.hpp"
#include "der/core/constants.hpp"
#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/core/reserve_more.hpp"
#include "der/energies/registry.hpp"
#include "der/loads/circulatory.hpp"
#include "der/loads/loads.hpp"
#include "der/model/cross_section.hpp"
#include "der/model/internal_damping.hpp"
#include "der/model/location.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/model_choice.hpp"
#include "der/scenario/scenario.hpp"
#include "der/supports/axial_spring.hpp"
#include "der/supports/clamp.hpp"
#include "der/supports/hinge.hpp"
#include "der/supports/spatial_clamp.hpp"
#include "der/supports/supports.hpp"
#include "model/corner_twist.hpp"
#include "model/curvature_jump.hpp"
#include "model/reference_edge.hpp"

namespace der {
namespace {

/// Returns whether sections count.
bool choose_model(const scenario::Scene& scene, Model& model) {
  const auto [kind, reason] = scenario::choose_model(scene);
  model.dimension = kind == scenario::ModelChoice::Planar ? 2 : 3;
  model.name = name_of(kind);
  model.reason = reason;
  model.stands_for_space = scene.model == scenario::ModelChoice::Auto && scene.in_space &&
                           kind != scenario::ModelChoice::Spatial;
  return kind == scenario::ModelChoice::Spatial;
}

/// The nodes of each rod. Rods share those of their joints.
std::vector<std::vector<Index>> number_nodes(const scenario::Scene& scene, Model& model) {
  std::vector<std::vector<Index>> nodes;
  std::vector<std::vector<int>> joint_at;  // number of the joint; -1: none
  for (const auto& rod : scene.rods) {
    nodes.emplace_back(rod.points.size(), -1);
    joint_at.emplace_back(rod.points.size(), -1);
  }
  const std::vector<std::vector<JoinedPlace>> joints = joined_places(scene);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (const auto& [rod, at] : joints[j]) joint_at[rod][to_size(at)] = static_cast<int>(j);
  }
  for (std::size_t rod = 0; rod < nodes.size(); ++rod) {
    for (std::size_t place = 0; place < nodes[rod].size(); ++place) {
      if (nodes[rod][place] >= 0) continue;
      const Index node = model.num_nodes++;
      nodes[rod][place] = node;
      if (joint_at[rod][place] < 0) continue;
      for (const auto& [other, at] : joints[to_size(joint_at[rod][place])]) {
        nodes[other][to_size(at)] = node;
      }
    }
  }
  return nodes;
}

/// Returns the nodes of each rod.
std::vector<std::vector<Index>> place_nodes(const scenario::Scene& scene, bool with_sections,
                                            Model& model) {
  std::vector<std::vector<Index>> nodes = number_nodes(scene, model);
  std::vector<Index> edge_starts;
  for (std::size_t i = 0; with_sections && i < nodes.size(); ++i) {
    const auto last = nodes[i].end() - (scene.rods[i].closed ? 0 : 1);
    edge_starts.insert(edge_starts.end(), nodes[i].begin(), last);
  }
  model.dofs = DofMap(model.dimension, model.num_nodes, edge_starts);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (scene.rods[i].closed) model.dofs.close(nodes[i]);
  }
  model.initial_frames.setZero(FrameBlock::kSize * static_cast<Index>(edge_starts.size()));
  const Index dofs = model.num_dofs();
  for (Vector* v : {&model.initial_positions, &model.reference_positions, &model.initial_velocities,
                    &model.mass.lumped, &model.damping, &model.gravity_force, &model.dead_force}) {
    v->setZero(dofs);
  }
  return nodes;
}

auto rest_position(const Model& model, Index node) {
  return model.reference_positions.segment(model.dof(node, 0), model.dimension);
}

/// Direction of the section's width at the rod's start, not yet perpendicular to the tangent there.
Vec3 first_director(const scenario::Rod& rod, const Vec3& tangent) {
  if (rod.director) return Eigen::Map<const Vec3>(rod.director->data()).stableNormalized();
  const Vec3 across_plane = Vec3::UnitZ();
  return across_plane.cross(tangent).norm() > 1e-6 ? across_plane : Vec3(tangent.unitOrthogonal());
}

/// The director stands across the tangent at the rod's start, not across its first edge, which
/// leans against it on a curve. It is transported along the drawn rod without twist, then turned by
/// the initial twist.
void draw_sections(const scenario::Rod& rod, RodMesh& layout, const Model& model) {
  layout.initial_twist = rod.initial_twist;
  Vec3 tangent = first_tangent(layout, model);
  Vec3 director = made_perpendicular(first_director(rod, tangent), tangent);
  // With a natural curvature, which the layout does not have yet, it has none.
  const bool has_corners =
      std::holds_alternative<scenario::StressFreeReference>(rod.natural_curvature);
  for (Index edge = 0; edge < layout.num_edges(); ++edge) {
    const Vec3 next = reference_edge<3>(layout, edge, model).normalized();
    director = made_perpendicular(transport(director, tangent, next), next);
    if (has_corners && edge > 0) {
      director = SectionFrame::of(next, director).turned(corner_twist(layout, edge, model)).first;
    }
    tangent = next;
    layout.initial_frames.push_back(
        SectionFrame::of(tangent, director).turned(rod.initial_twist * layout.edge_middle(edge)));
  }
}

/// RodMesh::director
Vec2 director_across(const scenario::Rod& rod, const RodMesh& layout, const Model& model) {
  const double angle = initial_tangent_angle(layout, 0, model);
  const Vec3 tangent(std::cos(angle), std::sin(angle), 0.0);
  const Vec3 director = first_director(rod, tangent);
  return Vec2(director.dot(Vec3::UnitZ().cross(tangent)), director.z()).normalized();
}

/// The corners and jumps of curvature that the scene tells.
void take_borders(const scenario::Rod& rod, double rest_scale, RodMesh& layout) {
  if (!rod.borders) return;
  layout.drawn_corners.emplace(rod.borders->corners.begin(), rod.borders->corners.end());
  for (const auto& [node, turn] : rod.borders->jumps) {
    layout.reference_jumps.push_back({node, Vec3(turn[0], turn[1], turn[2]) / rest_scale});
  }
}

/// The only place that makes a chain of nodes; everything after it reads the layout's lists.
/// In a scene with joints rods share nodes: the reference is then as drawn, and rest lengths are
/// those of the edges alone.
RodMesh lay_out(const scenario::Rod& rod, const SectionProperties& section,
                std::vector<Index> nodes, bool has_joints, Model& model) {
  RodMesh layout;
  layout.name = rod.name;
  layout.closed = rod.closed;
  layout.curvature = rod.curvature;
  layout.EA = section.EA;
  layout.EI = section.EI;
  layout.EI_1 = section.EI1;
  layout.EI_2 = section.EI2;
  layout.GJ = section.GJ;
  layout.spin_inertia = section.spin_inertia;
  layout.damping = section.damping;
  layout.first_edge = static_cast<Index>(model.edges.size());
  layout.draw_radius = section.draw_radius;

  layout.nodes = std::move(nodes);
  layout.arc_length.reserve(rod.points.size());
  layout.edge_length.reserve(rod.points.size());
  const double scale = scenario::rest_scale(rod);
  const double magnified = has_joints ? 1.0 : scale;  // exact places without a rest length
  double s = 0.0;
  for (std::size_t i = 0; i < rod.points.size(); ++i) {
    const Index node = layout.nodes[i];
    for (int c = 0; c < model.dimension; ++c) {
      const double first = rod.points.front()[to_size(c)];
      const double here = rod.points[i][to_size(c)];
      model.initial_positions[model.dof(node, c)] = here;
      model.reference_positions[model.dof(node, c)] =
          magnified == 1.0 ? here : first + magnified * (here - first);
      if (!rod.initial_velocity.empty()) {
        model.initial_velocities[model.dof(node, c)] = rod.initial_velocity[i][to_size(c)];
      }
    }
    if (i > 0) {
      layout.edge_length.push_back(
          scale / magnified *
          (rest_position(model, node) - rest_position(model, layout.nodes[i - 1])).norm());
      s += layout.edge_length.back();
    }
    layout.arc_length.push_back(s);
  }
  if (rod.closed) {
    layout.edge_length.push_back(
        (rest_position(model, layout.nodes.front()) - rest_position(model, layout.nodes.back()))
            .norm());
  }
  reserve_more(model.edges, to_size(layout.num_edges()));
  for (Index edge = 0; edge < layout.num_edges(); ++edge) {
    model.edges.push_back(layout.edge(edge, model));
  }
  layout.sphere_radius.assign(rod.points.size(), 0.0);
  take_borders(rod, scale, layout);
  if (model.dimension == 3) {
    draw_sections(rod, layout, model);
  } else {
    layout.director = director_across(rod, layout, model);
  }
  return layout;
}

void set_natural_twist(const scenario::Rod& rod, RodMesh& layout) {
  if (const auto* constant = std::get_if<double>(&rod.natural_twist)) {
    layout.natural_twist.assign(layout.nodes.size(), *constant);
  } else if (const auto* list = std::get_if<std::vector<double>>(&rod.natural_twist)) {
    layout.natural_twist = *list;
  }
}

void set_natural_curvature(const scenario::Rod& rod, RodMesh& layout) {
  if (const auto* constant = std::get_if<double>(&rod.natural_curvature)) {
    layout.natural_curvature.assign(layout.nodes.size(), *constant);
  } else if (const auto* list = std::get_if<std::vector<double>>(&rod.natural_curvature)) {
    layout.natural_curvature = *list;
  } else if (const auto* pair = std::get_if<scenario::CurvaturePair>(&rod.natural_curvature)) {
    layout.natural_curvatures.assign(layout.nodes.size(), {pair->first, pair->second});
  } else if (const auto* pairs =
                 std::get_if<std::vector<scenario::CurvaturePair>>(&rod.natural_curvature)) {
    for (const auto& [first, second] : *pairs)
      layout.natural_curvatures.emplace_back(first, second);
  }
}

void add_mass(Index node, double mass, Model& model) {
  for (int c = 0; c < model.dimension; ++c) model.mass.lumped[model.dof(node, c)] += mass;
}

/// Lumped masses: each node carries its Voronoi cell and its sphere, each edge its inertia against
/// spin.
void lump_masses(const scenario::Rod& rod, RodMesh& layout, Model& model) {
  std::vector<double> sphere_mass(layout.nodes.size(), 0.0);
  for (const auto& sphere : rod.spheres) {
    for (const Index place : nodes_at(sphere.at, layout)) {
      layout.sphere_radius[to_size(place)] = sphere.radius;
      sphere_mass[to_size(place)] = sphere.density * (4.0 / 3.0 * kPi * std::pow(sphere.radius, 3));
    }
  }
  for (std::size_t i = 0; i < layout.nodes.size(); ++i) {
    add_mass(layout.nodes[i],
             layout.mass_per_length * layout.voronoi_length(static_cast<Index>(i)) + sphere_mass[i],
             model);
  }
  if (!model.has_sections()) return;
  for (Index edge = 0; edge < layout.num_edges(); ++edge) {
    model.mass.lumped[model.dofs.angle(layout.first_edge + edge)] =
        layout.spin_inertia * layout.edge_length[to_size(edge)];
  }
}

/// The part of each edge's consistent mass that is not lumped, between free degrees of freedom.
/// Every other edge first: sums over the list then do not wait for the entry just written.
void couple_masses(const RodMesh& rod, Model& model) {
  if (rod.mass_per_length == 0.0) return;
  reserve_more(model.mass.coupling, to_size(rod.num_edges() * model.dimension));
  for (const Index first : {0, 1}) {
    for (Index edge = first; edge < rod.num_edges(); edge += 2) {
      const double mass = rod.mass_per_length * rod.edge_length[to_size(edge)] / 6.0;
      for (int c = 0; c < model.dimension; ++c) {
        const Index a = model.dof(rod.nodes[to_size(edge)], c);
        const Index b = model.dof(rod.node(edge + 1), c);
        if (!model.dofs.is_free(a) || !model.dofs.is_free(b)) continue;
        model.mass.coupling.push_back({a, b, mass});
      }
    }
  }
}

/// `nodes`: those of each rod.
void lay_out_rods(const scenario::Scene& scene, std::vector<std::vector<Index>> nodes,
                  Model& model) {
  double size = 0.0;
  for (std::size_t i = 0; i < scene.rods.size(); ++i) {
    const scenario::Rod& rod = scene.rods[i];
    const SectionProperties section = section_properties(rod);
    RodMesh layout = lay_out(rod, section, std::move(nodes[i]), !scene.joints.empty(), model);
    layout.mass_per_length = section.mass_per_length;
    set_natural_curvature(rod, layout);
    set_natural_twist(rod, layout);
    lump_masses(rod, layout, model);
    size = std::max(size, layout.rest_length());
    if (!rod.borders) layout.reference_jumps = reference_jumps_of(layout, model);
    layout.natural_jumps = natural_jumps_of(layout, model);
    model.rods.push_back(std::move(layout));
  }
  model.dofs.set_length(size);
}

/// Behind the frames of edges and joints.
void number_controls(const scenario::Scene& scene, Model& model) {
  model.natural_strain = NaturalStrain(static_cast<Index>(model.initial_frames.size()),
                                       num_rest_entries(scene, model.dimension));
  model.tables = TimeTables(model.natural_strain.end());
  set_rest_entries(scene, model);
}

void check_spin_inertia(const Model& model) {
  for (const RodMesh& rod : model.rods) {
    const bool bends = !rod.vertices.empty() || (!rod.legs.empty() && rod.EI_1 > 0.0);
    if (!model.has_sections() || !bends || rod.spin_inertia > 0.0) continue;
    throw Error(
        "model_error",
        "the sections of rod '" + rod.name +
            "' have no inertia against spin, which a run over time in space needs: give the "
            "rod a density, or its stiffnesses a 'rotary_inertia'");
  }
}

/// Lets the state follow whole turns of planar rods whose slope is probed and which no clamp holds.
void follow_slopes(const scenario::Scene& scene, Model& model) {
  if (model.dimension != 2 || model.has_rotations()) return;
  for (const auto& probe : scene.output.probes) {
    if (probe.quantity != kSlope) continue;
    const RodMesh& rod = model.rod(probe.rod.value());
    const Edge first = rod.edge(0, model);
    const bool followed =
        std::any_of(model.followed_edges.begin(), model.followed_edges.end(),
                    [&](const FollowedEdge& other) { return other.edge.first == first.first; });
    if (rod.clamps.empty() && !followed) follow_edge(rod, 0, model);
  }
}

void hold_dofs(Model& model) {
  std::vector<Index> held;
  for (const HeldDof& support : model.held) {
    held.push_back(support.dof);
    model.initial_velocities[support.dof] = 0.0;
  }
  model.dofs.hold(held);
  if (model.num_free() == 0) {
    throw Error("model_error", "every node is held by a support: there is nothing to find");
  }
}

}  // namespace

Model build_model(const scenario::Scene& scene, LegOrder order) {
  Model model;
  model.elements = make_hidden<ElementLists>();
  const bool with_sections = choose_model(scene, model);
  lay_out_rods(scene, place_nodes(scene, with_sections, model), model);
  find_joints(scene, model);
  for (const auto& joint : scene.joints) add_hinge(joint, model);
  number_controls(scene, model);
  for (const auto& joint : scene.joints) drive_hinge(joint, model);
  for (const auto& spring : scene.springs) add_axial_spring(spring, scene, model);
  find_force_nodes(scene, model);
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    add_support(scene.supports[i], i, model);
  }
  for (RodMesh& rod : model.rods) {
    const ElementCounts before = count_elements(model);
    if (!rod.legs.empty() && model.dimension == 3) {
      add_spatial_leg_elements(rod, model);
    } else if (!rod.legs.empty()) {
      add_leg_elements(rod, order == LegOrder::Fourth, model);
    } else if (model.dimension == 2) {
      add_rod_elements(rod, model);
    } else {
      add_spatial_rod_elements(rod, model);
    }
    if (rod.damping.any()) damp_elements(rod.damping, before, model);
    model.viscous = model.viscous || rod.damping.any();
  }
  for (const auto& actuation : scene.actuations) add_actuation(actuation, model);
  for (const auto& load : scene.loads) {
    std::visit([&](const auto& l) { add_load(l, LoadContext{scene, load.name}, model); },
               load.what);
  }
  for (const RodMesh& rod : model.rods) {
    if (model.dimension == 2) turn_followers_under_moments(rod, model);
    if (model.has_sections()) act_on_loaded_sections(rod, model);
  }
  const Index angles = model.num_dofs() - model.dofs.num_positions();
  model.initial_positions.tail(angles) = model.reference_positions.tail(angles);
  set_actuated_turns(model);
  follow_slopes(scene, model);
  model.damped = (model.damping.array() != 0.0).any();
  hold_dofs(model);
  if (scene.is_dynamic()) check_spin_inertia(model);
  for (const RodMesh& rod : model.rods) couple_masses(rod, model);
  model.load_variation = load_variation(scene, model);
  return model;
}

bool has_arcs(const Model& model) {
  return std::any_of(model.rods.begin(), model.rods.end(), [](const RodMesh& rod) {
    return std::any_of(rod.legs.begin(), rod.legs.end(),
                       [](const Leg& leg) { return !leg.arcs.empty(); });
  });
}

}  // namespace der
