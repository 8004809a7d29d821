#include "der/model/builder.hpp"

#include <cmath>
#include <cstddef>

#include "der/core/constants.hpp"
#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/loads/loads.hpp"
#include "der/model/cross_section.hpp"
#include "der/model/location.hpp"
#include "der/supports/supports.hpp"

namespace der {
namespace {

void choose_model(const scenario::Scene& scene, Model& model) {
  model.dimension = 2;
  model.name = "planar";
  model.reason = scene.model == scenario::ModelChoice::Planar
                     ? "asked for by the scene"
                     : "every position, force and support lies in the x-y plane";
}

void place_nodes(const scenario::Scene& scene, Model& model) {
  for (const auto& rod : scene.rods) model.num_nodes += static_cast<Index>(rod.points.size());
  const Index dofs = model.num_dofs();
  for (Vector* v : {&model.initial_positions, &model.initial_velocities, &model.mass,
                    &model.damping, &model.gravity_force, &model.dead_force}) {
    v->setZero(dofs);
  }
}

Vec2 position(const Model& model, Index node) {
  return model.initial_positions.segment<2>(model.dof(node, 0));
}

/// The only place that makes a chain of nodes; everything after it reads the layout's lists.
RodLayout lay_out(const scenario::Rod& rod, const SectionProperties& section, Index first_node,
                  Model& model) {
  RodLayout layout;
  layout.name = rod.name;
  layout.curvature = rod.curvature;
  layout.EA = section.EA;
  layout.EI = section.EI;
  layout.draw_radius = section.draw_radius;

  layout.arc_length.push_back(0.0);
  for (std::size_t i = 0; i < rod.points.size(); ++i) {
    const Index node = first_node + static_cast<Index>(i);
    layout.nodes.push_back(node);
    for (int c = 0; c < model.dimension; ++c) {
      model.initial_positions[model.dof(node, c)] = rod.points[i][at(c)];
      if (!rod.initial_velocity.empty()) {
        model.initial_velocities[model.dof(node, c)] = rod.initial_velocity[i][at(c)];
      }
    }
    if (i == 0) continue;
    layout.edge_length.push_back((position(model, node) - position(model, node - 1)).norm());
    layout.arc_length.push_back(layout.arc_length.back() + layout.edge_length.back());
  }
  layout.sphere_radius.assign(rod.points.size(), 0.0);
  return layout;
}

void set_natural_curvature(const scenario::Rod& rod, const Model& model, RodLayout& layout) {
  const std::size_t count = layout.nodes.size();
  if (const auto* constant = std::get_if<double>(&rod.natural_curvature)) {
    layout.natural_curvature.assign(count, *constant);
  } else if (const auto* list = std::get_if<std::vector<double>>(&rod.natural_curvature)) {
    layout.natural_curvature = *list;
  }
  layout.rest_turning_angle.assign(count, 0.0);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    if (layout.natural_curvature.empty()) {
      const Vec2 x = position(model, layout.nodes[i]);
      layout.rest_turning_angle[i] = angle_between(x - position(model, layout.nodes[i - 1]),
                                                   position(model, layout.nodes[i + 1]) - x);
    } else {
      layout.rest_turning_angle[i] =
          layout.natural_curvature[i] * layout.voronoi_length(static_cast<Index>(i));
    }
  }
}

void add_mass(Index node, double mass, Model& model) {
  for (int c = 0; c < model.dimension; ++c) model.mass[model.dof(node, c)] += mass;
}

/// Lumped masses: each node carries its Voronoi cell and its sphere.
void lump_masses(const scenario::Rod& rod, double mass_per_length, RodLayout& layout,
                 Model& model) {
  std::vector<double> sphere_density(layout.nodes.size(), 0.0);
  for (const auto& sphere : rod.spheres) {
    for (const Index place : nodes_at(sphere.at, layout)) {
      layout.sphere_radius[at(place)] = sphere.radius;
      sphere_density[at(place)] = sphere.density;
    }
  }
  for (std::size_t i = 0; i < layout.nodes.size(); ++i) {
    const double volume = 4.0 / 3.0 * kPi * std::pow(layout.sphere_radius[i], 3);
    add_mass(
        layout.nodes[i],
        mass_per_length * layout.voronoi_length(static_cast<Index>(i)) + sphere_density[i] * volume,
        model);
  }
}

void add_stretch(const RodLayout& rod, Model& model) {
  auto& list = std::get<ElementList<Stretch<2>>>(model.elements);
  for (Index edge = 0; edge < rod.num_edges(); ++edge) {
    list.add(rod.edge_dofs(edge, model), {rod.EA, rod.edge_length[at(edge)]});
  }
}

template <class Curvature>
void add_bend(const scenario::Scene& scene, const RodLayout& rod, Model& model) {
  auto& list = std::get<ElementList<PlanarBend<Curvature>>>(model.elements);
  for (Index i = 1; i < rod.num_edges(); ++i) {
    if (is_clamped(scene, rod, i)) continue;
    const auto before = rod.edge_dofs(i - 1, model);
    const auto after = rod.edge_dofs(i, model);
    list.add({before[0], before[1], after[0], after[1], after[2], after[3]},
             {rod.EI / rod.voronoi_length(i), Curvature::of(rod.rest_turning_angle[at(i)]).kappa});
  }
}

void build_rods(const scenario::Scene& scene, Model& model) {
  Index first_node = 0;
  for (const auto& rod : scene.rods) {
    const SectionProperties section = section_properties(rod.cross_section, rod.material);
    RodLayout layout = lay_out(rod, section, first_node, model);
    set_natural_curvature(rod, model, layout);
    lump_masses(rod, section.mass_per_length, layout, model);
    add_stretch(layout, model);
    if (layout.EI > 0.0) {
      if (layout.curvature == scenario::CurvatureMeasure::Angle) {
        add_bend<AngleCurvature>(scene, layout, model);
      } else {
        add_bend<TangentCurvature>(scene, layout, model);
      }
    }
    first_node += static_cast<Index>(rod.points.size());
    model.size = std::max(model.size, layout.rest_length());
    model.rods.push_back(std::move(layout));
  }
}

void number_free_dofs(Model& model) {
  model.free_index.assign(at(model.num_dofs()), 0);
  for (const HeldDof& held : model.held) {
    model.free_index[at(held.dof)] = -1;
    model.initial_velocities[held.dof] = 0.0;
  }
  for (Index dof = 0; dof < model.num_dofs(); ++dof) {
    if (model.free_index[at(dof)] < 0) continue;
    model.free_index[at(dof)] = model.num_free();
    model.free_dofs.push_back(dof);
  }
  if (model.free_dofs.empty()) {
    throw Error("model_error", "every node is held by a support: there is nothing to find");
  }
}

}  // namespace

Model build_model(const scenario::Scene& scene) {
  Model model;
  choose_model(scene, model);
  place_nodes(scene, model);
  build_rods(scene, model);
  for (const auto& support : scene.supports) add_support(support, model);
  for (const auto& load : scene.loads) {
    std::visit([&](const auto& l) { add_load(l, scene, model); }, load.what);
  }
  number_free_dofs(model);
  return model;
}

}  // namespace der
