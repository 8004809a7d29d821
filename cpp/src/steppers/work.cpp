#include "der/steppers/work.hpp"

#include <type_traits>

#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

bool any_clamp_turns(const Model& model) {
  bool any = false;
  for (const RodLayout& rod : model.rods) {
    for (const Clamp& clamp : rod.clamps) {
      for_each_turning_control(clamp, [&](Index /*control*/) { any = true; });
    }
  }
  return any;
}

/// Energy [J] that elements take up as the controls change from those of `before` to those of
/// `after`: the mean of that at the coordinates of the ends of a step.
double energy_given(const Model& model, const Configuration& before, const Configuration& after,
                    const Configuration& start, const Configuration& end) {
  double energy = 0.0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm != EnergyTerm::Load) {
      for (const Configuration* there : {&start, &end}) {
        energy += 0.5 * (element_energy(list, after, there->coordinates) -
                         element_energy(list, before, there->coordinates));
      }
    }
  });
  return energy;
}

}  // namespace

void stage_displacement(const Model& model, const Vector& start, const Vector& end, double share,
                        double dt, const Eigen::Ref<const Vector>& velocities,
                        Vector& displacement) {
  displacement = share * dt * velocities;
  for (const HeldDof& held : model.held) {
    displacement[held.dof] = share * (end[held.dof] - start[held.dof]);
  }
}

double moment_work(const Model& model, const Configuration& here, const Vector& displacement) {
  double work = circulatory_work(circulatory_loads(*model.elements), here, displacement);
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm == EnergyTerm::Load) {
      LocalTerm<Kernel::kDofs> local;
      for (std::size_t e = 0; e < list.size(); ++e) {
        Kernel::template evaluate<Derivatives::Gradient>(
            list.constants[e], here, gather(list.dofs[e], here.coordinates), local);
        work -= local.gradient.dot(gather(list.dofs[e], displacement));
      }
    }
  });
  return work;
}

ControlWork control_work(const Model& model, const Configuration& start, const Configuration& end) {
  const bool turns = any_clamp_turns(model);
  if (!model.rest_shape.is_actuated()) {
    return {turns ? energy_given(model, start, end, start, end) : 0.0, 0.0};
  }
  if (!turns) return {0.0, energy_given(model, start, end, start, end)};
  // Each of the two changes first, and after the other.
  Configuration turned = end;
  model.rest_shape.copy(start.controls, turned.controls);
  Configuration actuated = start;
  model.rest_shape.copy(end.controls, actuated.controls);
  const auto given = [&](const Configuration& before, const Configuration& after) {
    return 0.5 * energy_given(model, before, after, start, end);
  };
  return {given(start, turned) + given(actuated, end), given(start, actuated) + given(turned, end)};
}

}  // namespace der
