#include "statics/equilibrium/moment_turning.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/planar_moments.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der::statics {
namespace {

/// Largest turn [1/(N m)] of a rod and of a spring against turning by a unit moment, added up.
double rotational_compliance(const Model& model) {
  double rods = 0.0;
  double springs = 0.0;
  for (const RodMesh& rod : model.rods) {
    if (rod.EI > 0.0) rods = std::max(rods, rod.rest_length() / rod.EI);
    for (const MomentPlace& place : rod.moment_places) {
      if (place.stiffness > 0.0) springs = std::max(springs, 1.0 / place.stiffness);
    }
  }
  return rods + springs;
}

}  // namespace

PlanarMomentTurning::PlanarMomentTurning(const Model& model)
    : compliance_(rotational_compliance(model)) {
  for_each_planar_moment(*model.elements, [&](const auto& dofs, const PlanarMoment::Constants& c) {
    moments_.push_back({dofs, c.moment});
  });
  turned_.setZero(static_cast<Index>(moments_.size()));
}

void PlanarMomentTurning::add(const Vector& from, const Vector& to) {
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    const auto before = gather(moments_[i].dofs, from);
    const auto after = gather(moments_[i].dofs, to);
    turned_[static_cast<Index>(i)] +=
        angle_between(before.tail<2>() - before.head<2>(), after.tail<2>() - after.head<2>());
  }
}

bool PlanarMomentTurning::is_unbounded(const Vector& controls) const {
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    const double moment = std::abs(controls[moments_[i].control]);
    const double turned = std::abs(turned_[static_cast<Index>(i)]);
    if (turned > 4.0 * kPi + 2.0 * moment * compliance_) return true;
  }
  return false;
}

}  // namespace der::statics
