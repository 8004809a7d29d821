#include "output/energy_reader.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "der/model/gravity.hpp"
#include "der/model/moment_place.hpp"

namespace der {
namespace {

/// The part of a model whose energy is read, or the whole model. Its weight is not kept, as it
/// follows the load factor and the controls of the state.
struct Part {
  Mass mass;
  std::vector<Index> dofs;
  ElementLists elements;
  std::vector<RodMesh> rods;

  [[nodiscard]] double gravity_energy(const Model& model, const State& state) const {
    const auto energy_in = [&](const auto& weight) {
      double energy = 0.0;
      for (const Index dof : dofs) energy -= weight[dof] * state.positions[dof];
      return energy;
    };
    const double driven =
        model.gravity_controls[0] < 0
            ? 0.0
            : driven_gravity_energy(model, mass.lumped, configuration_of(model, state));
    if (!model.load_variation) return driven + energy_in(model.gravity_force);
    return driven + energy_in(model.load_variation->gravity_force.at(state.load_factor));
  }
};

class EnergyReader : public ProbeReader {
 public:
  EnergyReader(std::vector<EnergyTerm> terms, Part part)
      : terms_(std::move(terms)), part_(std::move(part)) {}

  double value(const Model& model, const State& state) override {
    double energy = 0.0;
    if (reads(EnergyTerm::Kinetic)) energy += part_.mass.kinetic_energy(state.velocities);
    if (reads(EnergyTerm::Gravity)) energy += part_.gravity_energy(model, state);
    if (reads_elastic()) energy += elastic(model, state);
    return energy;
  }

 private:
  [[nodiscard]] bool reads(EnergyTerm term) const {
    return std::find(terms_.begin(), terms_.end(), term) != terms_.end();
  }
  [[nodiscard]] bool reads_elastic() const {
    return std::any_of(kEnergyTerms.begin(), kEnergyTerms.end(),
                       [&](const EnergyTermInfo& row) { return row.elastic && reads(row.term); });
  }

  double elastic(const Model& model, const State& state) {
    configuration_of(model, state, here_);
    double energy = 0.0;
    for_each_list(part_.elements, [&](const auto& list) {
      constexpr EnergyTerm term = std::decay_t<decltype(list)>::KernelType::kTerm;
      if (reads(term)) energy += element_energy(list, here_);
    });
    for (const RodMesh& rod : part_.rods) {
      const Energies cells = cell_energies(rod, model, here_);
      for (const EnergyTerm term : terms_) energy += cells[term];
    }
    return energy;
  }

  std::vector<EnergyTerm> terms_;
  Part part_;
  Configuration here_;
};

std::vector<Index> rod_dofs(const RodMesh& rod, const Model& model) {
  std::vector<Index> dofs;
  for (const Index node : rod.nodes) {
    for (int c = 0; c < model.dimension; ++c) dofs.push_back(model.dof(node, c));
  }
  for (const Leg& leg : rod.legs) {
    for (const Index rotation : {leg.start.rotation, leg.end.rotation}) {
      for (Index c = 0; rotation >= 0 && c < (model.dimension == 3 ? 3 : 1); ++c) {
        dofs.push_back(model.dofs.rotation(rotation) + c);
      }
    }
  }
  if (model.has_sections()) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      dofs.push_back(model.dofs.angle(rod.first_edge + edge));
    }
  }
  return dofs;
}

/// The nodes and edges of a rod, and everything between them.
Part part_of(const RodMesh& rod, const Model& model) {
  std::vector<Index> dofs = rod_dofs(rod, model);
  std::sort(dofs.begin(), dofs.end());
  const auto is_here = [&](Index dof) { return std::binary_search(dofs.begin(), dofs.end(), dof); };

  Part part{{Vector::Zero(model.num_dofs()), {}}, dofs, {}, {rod}};
  for (const Index dof : dofs) part.mass.lumped[dof] = model.mass.lumped[dof];
  for (const MassCoupling& coupling : model.mass.coupling) {
    if (is_here(coupling.a) && is_here(coupling.b)) part.mass.coupling.push_back(coupling);
  }
  for_each_list(*model.elements, [&](const auto& list) {
    auto& kept = std::get<std::decay_t<decltype(list)>>(part.elements.lists);
    for (std::size_t e = 0; e < list.size(); ++e) {
      if (std::all_of(list.dofs[e].begin(), list.dofs[e].end(), is_here)) {
        kept.add(list.dofs[e], list.constants[e]);
      }
    }
  });
  return part;
}

Part whole(const Model& model) {
  std::vector<Index> dofs(static_cast<std::size_t>(model.num_dofs()));
  std::iota(dofs.begin(), dofs.end(), Index{0});
  return {model.mass, std::move(dofs), *model.elements, model.rods};
}

}  // namespace

std::unique_ptr<ProbeReader> make_energy_reader(const std::vector<EnergyTerm>& terms,
                                                const std::optional<std::string>& rod,
                                                const Model& model) {
  return std::make_unique<EnergyReader>(terms,
                                        rod ? part_of(model.rod(*rod), model) : whole(model));
}

}  // namespace der
