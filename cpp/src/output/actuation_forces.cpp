#include "der/output/actuation_forces.hpp"

#include <algorithm>
#include <tuple>
#include <type_traits>

#include "der/core/index.hpp"
#include "der/energies/element_energy.hpp"
#include "der/energies/registry.hpp"
#include "der/energies/rest_gradient.hpp"

namespace der {

/// The data that the forces of a model's actuations need.
class ActuationForces::Reader {
 public:
  Reader(const Model& model, const std::optional<std::string>& only);

  const std::vector<ActuationForce>& evaluate(const Model& model, const State& state);

 private:
  /// A part of an actuation in the rest shape of an element.
  struct Part {
    std::size_t force = 0;
    std::size_t value = 0;
    Index entry = 0;      // of the controls
    double weight = 0.0;  // over the length of the stretch [1/m]
  };

  void add_parts(const ActuatedStretch& stretch, const Model& model);
  void choose_elements(const Model& model);

  std::vector<ActuationForce> forces_;
  std::vector<Part> parts_;
  std::array<std::vector<std::size_t>, std::tuple_size_v<ElementLists::Lists>> elements_;
  // At the state.
  Configuration here_;
  Vector by_entry_;  // derivative of the energy by each entry of the rest shape
};

ActuationForces::Reader::Reader(const Model& model, const std::optional<std::string>& only)
    : by_entry_(Vector::Zero(model.natural_strain.end())) {
  for (const RodMesh& rod : model.rods) {
    for (const ActuatedStretch& stretch : rod.actuated_stretches) {
      if (only && *only != stretch.name) continue;
      ActuationForce force;
      force.name = stretch.name;
      force.rod = rod.name;
      force.length = stretch.integral(stretch.from, stretch.to);
      force.num_values = stretch.controls[1] < 0 ? 1 : 2;
      forces_.push_back(force);
      add_parts(stretch, model);
    }
  }
  choose_elements(model);
}

void ActuationForces::Reader::add_parts(const ActuatedStretch& stretch, const Model& model) {
  const ActuationForce& force = forces_.back();
  for (Index entry = 0; entry < model.natural_strain.end(); ++entry) {
    for (const NaturalStrain::Term& term : model.natural_strain.terms_of(entry)) {
      for (std::size_t value = 0; value < force.num_values; ++value) {
        if (term.control != stretch.controls[value]) continue;
        parts_.push_back({forces_.size() - 1, value, entry, term.weight / force.length});
      }
    }
  }
}

/// Those whose rest shape the actuations change.
void ActuationForces::Reader::choose_elements(const Model& model) {
  const auto is_read = [&](Index first, Index size) {
    return first >= 0 && std::any_of(parts_.begin(), parts_.end(), [&](const Part& part) {
             return first <= part.entry && part.entry < first + size;
           });
  };
  std::size_t kind = 0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (RestGradient<Kernel>::kExists) {
      for (std::size_t e = 0; e < list.size(); ++e) {
        const Index first = RestGradient<Kernel>::shift(list.constants[e]).entry;
        if (is_read(first, RestGradient<Kernel>::kSize)) elements_[kind].push_back(e);
      }
    }
    ++kind;
  });
}

const std::vector<ActuationForce>& ActuationForces::Reader::evaluate(const Model& model,
                                                                     const State& state) {
  configuration_of(model, state, here_);
  by_entry_.setZero();
  std::size_t kind = 0;
  for_each_list(*model.elements, [&](const auto& list) {
    using Kernel = typename std::decay_t<decltype(list)>::KernelType;
    if constexpr (RestGradient<Kernel>::kExists) {
      for (const std::size_t e : elements_[kind]) {
        const auto& constants = list.constants[e];
        const auto x = gather(list.dofs[e], here_.coordinates);
        by_entry_.template segment<RestGradient<Kernel>::kSize>(
            RestGradient<Kernel>::shift(constants).entry) +=
            RestGradient<Kernel>::of(constants, here_, x);
      }
    }
    ++kind;
  });
  for (ActuationForce& force : forces_) force.values.fill(0.0);
  for (const auto& [force, value, entry, weight] : parts_) {
    forces_[force].values[value] += weight * by_entry_[entry];
  }
  return forces_;
}

ActuationForces::ActuationForces(const Model& model, const std::optional<std::string>& only)
    : reader_(std::make_unique<Reader>(model, only)) {}

ActuationForces::~ActuationForces() = default;

const std::vector<ActuationForce>& ActuationForces::evaluate(const Model& model,
                                                             const State& state) {
  return reader_->evaluate(model, state);
}

}  // namespace der
