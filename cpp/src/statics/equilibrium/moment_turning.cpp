#include "statics/equilibrium/moment_turning.hpp"

#include <algorithm>
#include <cmath>

#include "der/core/constants.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/planar_moment.hpp"
#include "der/kinematics/planar_edge.hpp"

namespace der::statics {
namespace {

/// Largest turn [1/(N m)] of a rod and of a spring against turning by a unit moment, added up.
double rotational_compliance(const Model& model) {
  double rods = 0.0;
  double springs = 0.0;
  for (const RodLayout& rod : model.rods) {
    if (rod.EI > 0.0) rods = std::max(rods, rod.rest_length() / rod.EI);
    for (const MomentPlace& place : rod.moment_places) {
      if (place.stiffness > 0.0) springs = std::max(springs, 1.0 / place.stiffness);
    }
  }
  return rods + springs;
}

const ElementList<PlanarMoment>& moments_of(const Model& model) {
  return elements_of<PlanarMoment>(*model.elements);
}

}  // namespace

PlanarMomentTurning::PlanarMomentTurning(const Model& model)
    : model_(model),
      compliance_(rotational_compliance(model)),
      turned_(Vector::Zero(static_cast<Index>(moments_of(model).size()))) {}

void PlanarMomentTurning::add(const Vector& from, const Vector& to) {
  const auto& moments = moments_of(model_);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const auto before = gather(moments.dofs[i], from);
    const auto after = gather(moments.dofs[i], to);
    turned_[static_cast<Index>(i)] +=
        angle_between(before.tail<2>() - before.head<2>(), after.tail<2>() - after.head<2>());
  }
}

bool PlanarMomentTurning::is_unbounded(const Vector& controls) const {
  const auto& moments = moments_of(model_);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const double moment = std::abs(controls[moments.constants[i].moment]);
    const double turned = std::abs(turned_[static_cast<Index>(i)]);
    if (turned > 4.0 * kPi + 2.0 * moment * compliance_) return true;
  }
  return false;
}

}  // namespace der::statics
