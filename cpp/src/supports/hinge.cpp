#include "der/supports/hinge.hpp"

#include "der/energies/elements_of.hpp"
#include "der/energies/joint_spring.hpp"
#include "der/energies/strain_rate.hpp"
#include "der/model/location.hpp"
#include "model/hinge_sides.hpp"

namespace der {

void add_hinge(const scenario::Joint& joint, Model& model) {
  if (!joint.has_sides()) return;
  auto& list = elements_of<JointSpring<2>>(*model.elements);
  if (joint.damping > 0.0) {
    list.damped.push_back({list.size(), StrainRate<JointSpring<2>>::of_hinge(joint.damping)});
    model.viscous = true;
  }
  list.add(hinge_sides(joint, model), {joint.spring ? joint.spring->rotational_stiffness : 0.0});
}

void drive_hinge(const scenario::Joint& joint, Model& model) {
  if (!joint.prescribe) return;
  const Index control = model.tables.add(joint.prescribe->angle);
  const scenario::JointMember& turned = joint.of[1];
  RodMesh& rod = model.rod(turned.rod);
  const Index place = node_at(turned.at, rod);
  for (Leg& leg : rod.legs) {
    if (rod.position(leg.first) == place) leg.start.driven = control;
    if (rod.position(leg.last) == place) leg.end.driven = control;
  }
  model.driven_hinges.push_back(control);
  model.named.push_back({joint.name, false, {{"angle", "rad", {control}}}});
}

}  // namespace der
