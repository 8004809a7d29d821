#include "der/steppers/work.hpp"

#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

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

/// The turn that the tables of actuations make in a step [rad].
Vec3 turned(const ActuatedTurn& turn, const Configuration& start, const Configuration& end) {
  return turn.at(end.controls) - turn.at(start.controls);
}

double planar_work_on_actuated_turns(const RodLayout& rod, const Configuration& start,
                                     const Configuration& end) {
  double work = 0.0;
  for (const MomentPlace& place : rod.moment_places) {
    if (place.actuated.is_zero()) continue;
    const double turn = turned(place.actuated, start, end)[0];
    for (const Index moment : place.moments) {
      const double mean = 0.5 * (start.controls[moment] + end.controls[moment]);
      work += place.series_share(rod.EI) * mean * turn;
    }
  }
  return work;
}

double spatial_work_on_actuated_turns(const RodLayout& rod, const Model& model,
                                      const Configuration& start, const Configuration& end) {
  double work = 0.0;
  for (const SpatialMomentPlace& place : rod.spatial_moments) {
    if (place.actuated.is_zero()) continue;
    const Vec3 turn = turned(place.actuated, start, end);
    const CirculatoryLoad& load = circulatory_loads(*model.elements)[to_size(place.load)];
    const FramedEdge& nearer = load.nearer_edge();
    for (const Configuration* there : {&start, &end}) {
      const Mat3 axes = turning_axes(nearer.frame(*there).frame);
      work += 0.5 * load.moments(*there).whole.dot(axes * turn);
    }
  }
  return work;
}

/// Work [J] of moments on the turns that actuations make between the edges and the moments' places:
/// displacements of nodes do not have it.
double work_on_actuated_turns(const Model& model, const Configuration& start,
                              const Configuration& end) {
  double work = 0.0;
  for (const RodLayout& rod : model.rods) {
    if (rod.actuated_stretches.empty()) continue;
    work += planar_work_on_actuated_turns(rod, start, end) +
            spatial_work_on_actuated_turns(rod, model, start, end);
  }
  return work;
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
        evaluate_element<Kernel, Derivatives::Gradient>(
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
    return {turns ? energy_given(model, start, end, start, end) : 0.0, 0.0, 0.0};
  }
  const double loads = work_on_actuated_turns(model, start, end);
  if (!turns) return {0.0, energy_given(model, start, end, start, end) - loads, loads};
  // Each of the two changes first, and after the other.
  Configuration turned = end;
  model.rest_shape.copy(start.controls, turned.controls);
  Configuration actuated = start;
  model.rest_shape.copy(end.controls, actuated.controls);
  const auto given = [&](const Configuration& before, const Configuration& after) {
    return 0.5 * energy_given(model, before, after, start, end);
  };
  return {given(start, turned) + given(actuated, end),
          given(start, actuated) + given(turned, end) - loads, loads};
}

}  // namespace der
