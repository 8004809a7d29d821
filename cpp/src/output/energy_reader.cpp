#include "output/energy_reader.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "der/assembly/element_energy.hpp"
#include "der/core/error.hpp"

namespace der {
namespace {

/// Which terms a quantity adds up.
struct Terms {
  bool kinetic = false;
  bool stretch = false;
  bool bend = false;
  bool gravity = false;
};

Terms terms_of(const std::string& quantity) {
  if (quantity == "kinetic_energy") return {true, false, false, false};
  if (quantity == "stretch_energy") return {false, true, false, false};
  if (quantity == "bend_energy") return {false, false, true, false};
  if (quantity == "elastic_energy") return {false, true, true, false};
  if (quantity == "gravity_energy") return {false, false, false, true};
  if (quantity == "total_energy") return {true, true, true, true};
  throw Error("model_error", "'" + quantity + "' is not an energy");
}

class EnergyReader : public ProbeReader {
 public:
  EnergyReader(Terms terms, std::vector<Index> dofs, ElementLists elements)
      : terms_(terms), dofs_(std::move(dofs)), elements_(std::move(elements)) {}

  double value(const Model& model, const State& state) override {
    double energy = 0.0;
    for (const Index dof : dofs_) {
      const double v = state.velocities[dof];
      if (terms_.kinetic) energy += 0.5 * model.mass[dof] * v * v;
      if (terms_.gravity) energy -= model.gravity_force[dof] * state.positions[dof];
    }
    if (terms_.stretch || terms_.bend) energy += elastic(model, state);
    return energy;
  }

 private:
  double elastic(const Model& model, const State& state) {
    model.controls.evaluate(state.time, controls_);
    double energy = 0.0;
    for_each_list(elements_, [&](const auto& list) {
      constexpr EnergyTerm term = std::decay_t<decltype(list)>::KernelType::kTerm;
      if ((term == EnergyTerm::Stretch && terms_.stretch) ||
          (term == EnergyTerm::Bend && terms_.bend)) {
        energy += element_energy(list, controls_, state.positions);
      }
    });
    return energy;
  }

  Terms terms_;
  std::vector<Index> dofs_;  // whose kinetic and gravity energy counts
  ElementLists elements_;    // whose elastic energy counts
  Vector controls_;
};

std::vector<Index> rod_dofs(const RodLayout& rod, const Model& model) {
  std::vector<Index> dofs;
  for (const Index node : rod.nodes) {
    for (int c = 0; c < model.dimension; ++c) dofs.push_back(model.dof(node, c));
  }
  return dofs;
}

/// The elements all of whose degrees of freedom are in `dofs`.
ElementLists elements_on(std::vector<Index> dofs, const ElementLists& all) {
  std::sort(dofs.begin(), dofs.end());
  const auto is_here = [&](Index dof) { return std::binary_search(dofs.begin(), dofs.end(), dof); };
  ElementLists result;
  for_each_list(all, [&](const auto& list) {
    auto& kept = std::get<std::decay_t<decltype(list)>>(result);
    for (std::size_t e = 0; e < list.size(); ++e) {
      if (std::all_of(list.dofs[e].begin(), list.dofs[e].end(), is_here)) {
        kept.add(list.dofs[e], list.constants[e]);
      }
    }
  });
  return result;
}

}  // namespace

std::unique_ptr<ProbeReader> make_energy_reader(const std::string& quantity,
                                                const std::optional<std::string>& rod,
                                                const Model& model) {
  std::vector<Index> dofs(static_cast<std::size_t>(model.num_dofs()));
  for (std::size_t i = 0; i < dofs.size(); ++i) dofs[i] = static_cast<Index>(i);
  if (rod) dofs = rod_dofs(model.rod(*rod), model);
  ElementLists elements = rod ? elements_on(dofs, model.elements) : model.elements;
  return std::make_unique<EnergyReader>(terms_of(quantity), std::move(dofs), std::move(elements));
}

}  // namespace der
