#include "der/steppers/work.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/planar_moment.hpp"
#include "der/energies/registry.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/model/location.hpp"
#include "der/supports/clamp.hpp"

namespace der {
namespace {

/// Energy [J] that elements take up as the controls change.
double energy_given(const Model& model, const Configuration& before, const Configuration& after) {
  double energy = 0.0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (Kernel::kTerm != EnergyTerm::Load) {
      energy += element_energy(list, after) - element_energy(list, before);
    }
  });
  return energy;
}

/// The turn that the tables of actuations make [rad].
Vec3 turned(const ActuatedTurn& turn, const Configuration& before, const Configuration& after) {
  return turn.at(after.controls) - turn.at(before.controls);
}

double planar_work_on_actuated_turns(const RodMesh& rod, const Configuration& before,
                                     const Configuration& after) {
  double work = 0.0;
  for (const MomentPlace& place : rod.moment_places) {
    if (place.actuated.is_zero()) continue;
    const double turn = turned(place.actuated, before, after)[0];
    for (const Index moment : place.moments) {
      const double mean = 0.5 * (before.controls[moment] + after.controls[moment]);
      work += place.series_share(rod.EI) * mean * turn;
    }
  }
  return work;
}

double spatial_work_on_actuated_turns(const RodMesh& rod, const Model& model,
                                      const Configuration& before, const Configuration& after) {
  double work = 0.0;
  for (const SpatialMomentPlace& place : rod.spatial_moments) {
    if (place.actuated.is_zero()) continue;
    const Vec3 turn = turned(place.actuated, before, after);
    const CirculatoryLoad& load = circulatory_loads(*model.elements)[to_size(place.load)];
    const FramedEdge& nearer = load.nearer_edge();
    for (const Configuration* there : {&before, &after}) {
      const Mat3 axes = turning_axes(nearer.frame(*there).frame);
      work += 0.5 * load.moments(*there).whole.dot(axes * turn);
    }
  }
  return work;
}

/// Whether a clamp turns a point from which the edge starts, or at which it ends.
bool is_turned(const SpatialEdge& edge) {
  return edge.first.held.rotation >= 0 || edge.last.held.rotation >= 0;
}

/// Work [J] of moments on the turn that the transport of frames gives their edges along a
/// displacement of nodes, where it counts: of an edge that moves as a whole it is of the third
/// order in a step. The equations of motion are without it (model/spin.hpp).
double work_on_transport(const Model& model, const Configuration& here,
                         const Vector& displacement) {
  double work = 0.0;
  for (const CirculatoryLoad& load : circulatory_loads(*model.elements)) {
    const auto edges = load.turned_edges();
    for (std::size_t i = 0; i < edges.size() && edges[i] != nullptr; ++i) {
      const SpatialEdge& edge = edges[i]->edge;
      if (!is_turned(edge)) continue;
      const EdgeFrame frame = edges[i]->frame(here);
      const double torque = load.moments(here).on_edge[i].dot(frame.frame.tangent);
      const Vec3 moved = displacement.segment<3>(edge.end) - displacement.segment<3>(edge.start);
      work += torque * frame.spin.dot(moved);
    }
  }
  return work;
}

/// Work [J] of moments on the turns that actuations make between the edges and the moments' places:
/// displacements of nodes do not have it.
double work_on_actuated_turns(const Model& model, const Configuration& before,
                              const Configuration& after) {
  double work = 0.0;
  for (const RodMesh& rod : model.rods) {
    if (rod.actuated_stretches.empty()) continue;
    work += planar_work_on_actuated_turns(rod, before, after) +
            spatial_work_on_actuated_turns(rod, model, before, after);
  }
  return work;
}

/// Work [J] of planar moments on the turns that clamps give edges by their pivots.
double planar_work_at_pivots(const Model& model, const Configuration& before,
                             const Configuration& after) {
  using Kernel = FromPivot<PlanarMoment>;
  const auto& moments = elements_of<Kernel>(*model.elements);
  double work = 0.0;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const auto& c = moments.constants[i];
    const auto edge = [&](const Configuration& there) -> Vec2 {
      const auto ends =
          Kernel::from_pivots(c, there.controls, gather(moments.dofs[i], there.coordinates));
      return ends.tail<2>() - ends.head<2>();
    };
    const Index control = c.element.moment;
    const double mean = 0.5 * (before.controls[control] + after.controls[control]);
    work += c.element.share * mean * angle_between(edge(before), edge(after));
  }
  return work;
}

/// The part of a rod's moments that a clamp beside them bears works on the clamp's own turn [J].
double planar_work_on_clamps(const RodMesh& rod, const Configuration& before,
                             const Configuration& after) {
  double work = 0.0;
  for (const MomentPlace& place : rod.moment_places) {
    const auto beside = place_beside_clamp(rod, place.arc_length);
    if (!beside) continue;
    const Index rotation = rod.clamps[to_size(beside->clamp)].rotation;
    if (rotation < 0) continue;
    const double turn = after.controls[rotation] - before.controls[rotation];
    for (const Index moment : place.moments) {
      const double mean = 0.5 * (before.controls[moment] + after.controls[moment]);
      work += place.series_share(rod.EI) * (1.0 - beside->share()) * mean * turn;
    }
  }
  return work;
}

/// The small rotation [rad] that takes the direction of one vector to that of another.
Vec3 rotation_between(const Vec3& from, const Vec3& to) {
  const Vec3 axis = from.cross(to);
  const double size = axis.norm();
  return size > 0.0 ? Vec3(std::atan2(size, from.dot(to)) / size * axis) : Vec3(Vec3::Zero());
}

double turned_by(Index control, const Configuration& before, const Configuration& after) {
  return control < 0 ? 0.0 : after.controls[control] - before.controls[control];
}

/// Both works [J] of the moments on a rod in space.
double spatial_work_at_clamps(const RodMesh& rod, const Model& model, const Configuration& before,
                              const Configuration& after) {
  double work = 0.0;
  for (const SpatialMomentPlace& place : rod.spatial_moments) {
    const CirculatoryLoad& load = circulatory_loads(*model.elements)[to_size(place.load)];
    const EdgeMoments first = load.moments(before);
    const EdgeMoments last = load.moments(after);
    const auto edges = load.turned_edges();
    for (std::size_t k = 0; k < edges.size() && edges[k] != nullptr; ++k) {
      const SpatialEdge& edge = edges[k]->edge;
      const Vec3 turn = rotation_between(edge.vector(before.coordinates, before.controls),
                                         edge.vector(after.coordinates, after.controls));
      work += 0.5 * (first.on_edge[k] + last.on_edge[k]).dot(turn);
    }
    const auto beside = place_beside_clamp(rod, place.arc_length);
    if (!beside) continue;
    const HeldFrame& held = rod.clamps[to_size(beside->clamp)].held;
    const Vec3 turn = turned_by(held.rotation, before, after) * held.axis +
                      turned_by(held.twist, before, after) * held.tangent(after.controls);
    const auto borne = [](const EdgeMoments& moment) -> Vec3 {
      return moment.whole - moment.on_edge[0] - moment.on_edge[1];
    };
    work += 0.5 * (borne(first) + borne(last)).dot(turn);
  }
  return work;
}

/// Work [J] of moments on the turns that clamps give their places, through pivots of edges and
/// where the clamps bear a part of them: displacements of nodes do not have it.
double work_at_turned_clamps(const Model& model, const Configuration& before,
                             const Configuration& after) {
  double work = 0.0;
  if (model.dimension == 2) work += planar_work_at_pivots(model, before, after);
  for (const RodMesh& rod : model.rods) {
    work += model.dimension == 2 ? planar_work_on_clamps(rod, before, after)
                                 : spatial_work_at_clamps(rod, model, before, after);
  }
  return work;
}

bool any_rest_length_changes(const Model& model, const Configuration& before,
                             const Configuration& after) {
  return std::any_of(model.rest_lengths.begin(), model.rest_lengths.end(), [&](Index control) {
    return before.controls[control] != after.controls[control];
  });
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
  double work = circulatory_work(circulatory_loads(*model.elements), here, displacement) -
                work_on_transport(model, here, displacement);
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

ControlWork control_work(const Model& model, const Configuration& before,
                         const Configuration& after) {
  const bool turns = any_clamp_turns(model);
  const bool is_driven = turns || any_rest_length_changes(model, before, after);
  const double at_clamps = turns ? work_at_turned_clamps(model, before, after) : 0.0;
  if (!model.natural_strain.is_actuated()) {
    return {is_driven ? energy_given(model, before, after) - at_clamps : 0.0, 0.0, at_clamps};
  }
  const double loads = work_on_actuated_turns(model, before, after);
  if (!is_driven) return {0.0, energy_given(model, before, after) - loads, loads};
  // Each of the two changes first, and after the other.
  Configuration turned = after;
  model.natural_strain.copy(before.controls, turned.controls);
  Configuration actuated = before;
  model.natural_strain.copy(after.controls, actuated.controls);
  const auto given = [&](const Configuration& from, const Configuration& to) {
    return 0.5 * energy_given(model, from, to);
  };
  return {given(before, turned) + given(actuated, after) - at_clamps,
          given(before, actuated) + given(turned, after) - loads, loads + at_clamps};
}

}  // namespace der
