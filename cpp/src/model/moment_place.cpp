#include "der/model/moment_place.hpp"

#include <algorithm>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/elements_of.hpp"
#include "der/energies/from_pivot.hpp"
#include "der/energies/rotational_spring.hpp"
#include "der/model/clamp_cell.hpp"
#include "der/model/location.hpp"
#include "model/actuated_turn.hpp"
#include "model/pivot_offset.hpp"
#include "model/section_cells.hpp"

namespace der {
namespace {

double cell_length(const RodMesh& rod, const MomentPlace& place) {
  if (const auto beside = place_beside_clamp(rod, place.arc_length)) {
    return beside->share() * (1.0 - beside->share()) * beside->reach;
  }
  const double beyond = beyond_outer_middle(rod, place.arc_length);
  if (place.weights.size() == 1) return 2.0 / 3.0 * beyond;
  const double spacing =
      tangent_place(rod, place.first_edge + 1) - tangent_place(rod, place.first_edge);
  if (beyond == 0.0) return place.weights[0] * place.weights[1] * spacing;
  const double share = -std::min(place.weights[0], place.weights[1]);
  return beyond - share * (2.0 + share) * spacing;
}

double applied_moment(const MomentPlace& place, const Vector& controls) {
  double sum = 0.0;
  for (const Index moment : place.moments) sum += controls[moment];
  return sum;
}

/// Turn [rad] of the weighted directions from where the springs are slack without actuations, the
/// first edge having turned by `before` [rad] in the last state. `offset(pivot)` is where clamps
/// have their pivots [m].
template <int Edges, class Offset>
double turn_of(const MomentPlace& place, const RodMesh& rod, const Model& model,
               const Vector& coordinates, const Offset& offset, double before) {
  using Kernel = RotationalSpring<Edges>;
  const std::size_t number = to_size(place.spring);
  const bool is_beside_clamp = rod.clamp_at(place.first_edge) != nullptr ||
                               rod.clamp_at(place.first_edge + Edges) != nullptr;
  if (!is_beside_clamp) {
    const auto& springs = elements_of<Kernel>(*model.elements);
    return Kernel::turn(springs.constants[number], before,
                        gather(springs.dofs[number], coordinates));
  }
  using Pivoted = FromPivot<Kernel>;
  const auto& springs = elements_of<Pivoted>(*model.elements);
  const auto& [element, first, last] = springs.constants[number];
  return Kernel::turn(
      element, before,
      Pivoted::from_pivots(offset(first), offset(last), gather(springs.dofs[number], coordinates)));
}

/// 0 without springs.
template <class Offset>
double spring_turn(const MomentPlace& place, const RodMesh& rod, const Model& model,
                   const Vector& coordinates, const Offset& offset, double before) {
  if (place.spring < 0) return 0.0;
  return place.weights.size() == 1 ? turn_of<1>(place, rod, model, coordinates, offset, before)
                                   : turn_of<2>(place, rod, model, coordinates, offset, before);
}

/// The turn of the tangent at the place by a clamp beside it [rad]; `control(i)` is the value of a
/// control.
template <class Control>
double turn_by_clamp(const MomentPlace& place, const RodMesh& rod, const Control& control) {
  const auto beside = place_beside_clamp(rod, place.arc_length);
  if (!beside) return 0.0;
  const Index rotation = rod.clamps[to_size(beside->clamp)].rotation;
  return rotation < 0 ? 0.0 : (1.0 - beside->share()) * control(rotation);
}

double moment_of(const MomentPlace& place, const RodMesh& rod, double applied, double turn) {
  return place.series_share(rod.EI) * (applied - place.stiffness * turn);
}

/// Elastic energy [J] of the cells under the applied moments, with the springs slack.
double stored_by_loads(const Model& model, const Vector& controls) {
  double energy = 0.0;
  for (const RodMesh& rod : model.rods) {
    if (rod.EI == 0.0) continue;
    for (const MomentPlace& place : rod.moment_places) {
      const double applied = applied_moment(place, controls);
      energy += 0.5 * place.cell_length * place.series_share(rod.EI) * applied * applied / rod.EI;
    }
  }
  return energy;
}

}  // namespace

MomentPlace moment_place(double s, const RodMesh& rod) {
  std::vector<Weighted> edges = edge_weights(rod, s);
  std::sort(edges.begin(), edges.end(),
            [](const Weighted& a, const Weighted& b) { return a.place < b.place; });
  MomentPlace place;
  place.arc_length = s;
  place.first_edge = edges.front().place;
  for (const Weighted& edge : edges) place.weights.push_back(edge.weight);
  place.cell_length = cell_length(rod, place);
  return place;
}

MomentPlace& place_of_moments(double s, RodMesh& rod) {
  if (const MomentPlace* known = rod.moment_place_at(s)) {
    return rod.moment_places[static_cast<std::size_t>(known - rod.moment_places.data())];
  }
  return rod.moment_places.emplace_back(moment_place(s, rod));
}

double carried_moment(const MomentPlace& place, const RodMesh& rod, const Model& model,
                      const State& state, double applied) {
  const double before = place.followed >= 0 ? state.followed[place.followed] : 0.0;
  const auto offset = [&](const Pivot& pivot) { return offset_of(pivot, model, state); };
  const auto control = [&](Index number) { return control_value(model, state, number); };
  const double turn = spring_turn(place, rod, model, state.positions, offset, before) +
                      turn_by_clamp(place, rod, control) +
                      value_of(place.actuated, model, state)[0];
  return moment_of(place, rod, applied, turn);
}

Energies cell_energies(const RodMesh& rod, const Model& model, const Configuration& here) {
  if (model.has_sections()) return section_cell_energies(rod, model, here);
  Energies energies;
  if (rod.EI == 0.0) return energies;
  const auto offset = [&](const Pivot& pivot) { return pivot.offset(here.controls); };
  const auto control = [&](Index number) { return here.controls[number]; };
  for (const MomentPlace& place : rod.moment_places) {
    const double before = place.followed >= 0
                              ? here.controls[model.followed_edges[to_size(place.followed)].turn]
                              : 0.0;
    const double turn = spring_turn(place, rod, model, here.coordinates, offset, before) +
                        turn_by_clamp(place, rod, control) + place.actuated.at(here.controls)[0];
    const double moment = moment_of(place, rod, applied_moment(place, here.controls), turn);
    const double cell_turn = place.cell_length * moment / rod.EI;
    energies[EnergyTerm::Bend] += 0.5 * cell_turn * moment;
    const double tangent = turn + cell_turn;
    energies[EnergyTerm::Spring] +=
        0.5 * place.stiffness * (tangent * tangent - place.series_share(rod.EI) * turn * turn);
  }
  return energies;
}

double cell_work(const Model& model, const Configuration& start, const Configuration& end) {
  if (model.has_sections()) {
    return stored_by_section_moments(model, end) - stored_by_section_moments(model, start);
  }
  return stored_by_loads(model, end.controls) - stored_by_loads(model, start.controls);
}

}  // namespace der
