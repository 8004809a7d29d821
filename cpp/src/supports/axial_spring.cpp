#include "der/supports/axial_spring.hpp"

#include <algorithm>
#include <string>

#include "der/energies/axial_spring.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/model/dimension.hpp"
#include "der/model/location.hpp"

namespace der {

std::array<Index, 2> nodes_of(const scenario::AxialSpring& spring, const scenario::Scene& scene,
                              const Model& model) {
  const auto node = [&](const std::string& name) {
    return node_of(*std::find_if(scene.joints.begin(), scene.joints.end(),
                                 [&](const auto& joint) { return joint.name == name; }),
                   model);
  };
  return {node(spring.between[0]), node(spring.between[1])};
}

namespace {

scenario::Series rest_length_of(const scenario::AxialSpring& spring,
                                const std::array<Index, 2>& nodes, const Model& model) {
  if (spring.rest_length) return *spring.rest_length;
  const auto drawn = [&](Index node) {
    return model.reference_positions.segment(model.dof(node, 0), model.dimension);
  };
  scenario::Series length;
  length.values = {(drawn(nodes[1]) - drawn(nodes[0])).norm()};
  return length;
}

}  // namespace

void add_axial_spring(const scenario::AxialSpring& spring, const scenario::Scene& scene,
                      Model& model) {
  const std::array<Index, 2> nodes = nodes_of(spring, scene, model);
  const Index control = model.tables.add(rest_length_of(spring, nodes, model));
  model.rest_lengths.push_back(control);
  model.named.push_back({spring.name, false, {{"rest_length", "m", {control}}}});
  with_dimension(model, [&](auto dim) {
    using Kernel = AxialSpring<dim>;
    auto& list = elements_of<Kernel>(*model.elements);
    std::array<Index, Kernel::kDofs> dofs{};
    for (std::size_t i = 0; i < dofs.size(); ++i) {
      dofs[i] = model.dof(nodes[i / dim], static_cast<int>(i % dim));
    }
    if (spring.damping > 0.0) {
      list.damped.push_back({list.size(), StrainRate<Kernel>::of_spring(spring.damping)});
      model.viscous = true;
    }
    list.add(dofs, {spring.stiffness, control});
  });
}

}  // namespace der
