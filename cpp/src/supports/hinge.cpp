#include "der/supports/hinge.hpp"

#include "der/energies/elements_of.hpp"
#include "der/energies/joint_spring.hpp"
#include "der/energies/strain_rate.hpp"
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

}  // namespace der
