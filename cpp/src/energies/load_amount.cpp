#include "der/energies/load_amount.hpp"

#include <Eigen/Geometry>

#include "der/core/index.hpp"

namespace der {

Vec3 ActuatedSection::turned(const Vec3& vector, const Vector& controls) const {
  if (turn.is_zero()) return vector;
  const Vec3 rotation = axes * turn.at(controls);
  const double angle = rotation.norm();
  if (angle == 0.0) return vector;
  return Eigen::AngleAxisd(angle, rotation / angle) * vector;
}

Vec3 LoadAmount::at(const Vector& controls) const {
  Vec3 amount = Vec3::Zero();
  for (int c = 0; c < 3; ++c) {
    const Index control = components[to_size(c)];
    if (control >= 0) amount[c] = controls[control];
  }
  return actuated.turned(amount, controls);
}

}  // namespace der
