#include <algorithm>
#include <cmath>

#include "der/energies/planar_moment.hpp"
#include "der/loads/circulatory.hpp"
#include "der/loads/loads.hpp"
#include "der/model/location.hpp"
#include "der/model/moment_place.hpp"
#include "der/scenario/scenario.hpp"
#include "der/supports/clamp.hpp"
#include "energies/add_element.hpp"
#include "model/hinge_sides.hpp"

namespace der {
namespace {

/// The clamp that holds the tangent at arc length `s` [m]; null: none does.
const Clamp* clamp_there(const RodMesh& rod, double s) {
  const auto found = std::find_if(rod.clamps.begin(), rod.clamps.end(), [&](const Clamp& clamp) {
    return std::abs(rod.arc_length[static_cast<std::size_t>(clamp.place)] - s) <= rod.same_place();
  });
  return found == rod.clamps.end() ? nullptr : &*found;
}

/// The hinge between whose sides a moment acts; null: none.
const scenario::Joint* hinge_of(const scenario::Moment& load, const scenario::Scene& scene) {
  const auto found = std::find_if(scene.joints.begin(), scene.joints.end(), [&](const auto& joint) {
    return joint.name == load.joint && joint.kind == scenario::JointKind::Hinge;
  });
  return load.joint.empty() || found == scene.joints.end() ? nullptr : &*found;
}

}  // namespace

void add_load(const scenario::Moment& load, const LoadContext& context, Model& model) {
  RodMesh& rod = model.rod(load.rod);
  const double s = arc_length_of(load.at, rod);
  const Clamp* clamp = clamp_there(rod, s);
  if (model.dimension == 3) {
    if (clamp == nullptr || !clamp->holds_section) {
      add_spatial_moment(load.moment_vector, load.follower, s, rod, model);
      if (!context.name.empty()) {
        const auto& controls = model.elements->circulatory.back().amount.components;
        model.named.push_back(vector_control(context.name, "N m", controls));
      }
    }
    return;
  }
  const Index control = model.tables.add(load.moment);
  if (!context.name.empty()) {
    model.named.push_back({context.name, false, {{"z", "N m", {control}}}});
  }
  if (!rod.legs.empty()) {
    if (const scenario::Joint* hinge = hinge_of(load, context.scene)) {
      const auto [first, second] = hinge_sides(*hinge, model);
      model.controlled_forces.push_back({first, control, -1.0});
      model.controlled_forces.push_back({second, control, 1.0});
      return;
    }
    const Index rotation = rod.rotation_at(node_at(load.at, rod));
    // A clamp takes it up.
    const auto is_here = [&](const HeldDof& held) {
      return rotation >= 0 && held.dof == model.dofs.rotation(rotation);
    };
    const bool is_held = std::any_of(model.held.begin(), model.held.end(), is_here);
    if (rotation >= 0 && !is_held) {
      model.controlled_forces.push_back({model.dofs.rotation(rotation), control, 1.0});
    }
    return;
  }
  // The clamp takes it up; on the edges beside it, it would bend the rod by an error of order 1.
  if (clamp != nullptr) return;
  MomentPlace& place = place_of_moments(s, rod);
  place.moments.push_back(control);
  for (std::size_t i = 0; i < place.weights.size(); ++i) {
    const EffectiveEdge edge = effective_edge(rod, place.first_edge + static_cast<Index>(i), model);
    add_element<PlanarMoment>(edge.dofs, {place.series_share(rod.EI) * place.weights[i], control},
                              edge.first, edge.last, *model.elements);
  }
}

}  // namespace der
