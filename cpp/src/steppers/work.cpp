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

double rotation_work(const Model& model, const Configuration& start, const Configuration& end) {
  if (!any_clamp_turns(model)) return 0.0;
  double work = 0.0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm != EnergyTerm::Load) {
      for (const Configuration* there : {&start, &end}) {
        work += 0.5 * (element_energy(list, end, there->coordinates) -
                       element_energy(list, start, there->coordinates));
      }
    }
  });
  return work;
}

}  // namespace der
