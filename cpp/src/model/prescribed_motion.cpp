#include "der/model/prescribed_motion.hpp"

namespace der {

void apply_prescribed_motion(const Model& model, const Vector& controls, Vector& positions) {
  for (const HeldDof& held : model.held) {
    positions[held.dof] = model.initial_positions[held.dof] +
                          (held.displacement >= 0 ? controls[held.displacement] : 0.0);
  }
}

}  // namespace der
