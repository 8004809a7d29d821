#include "output/rod_field.hpp"

#include <fmt/format.h>

#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"
#include "output/bend_field.hpp"
#include "output/stretch_field.hpp"

namespace der {
namespace {

/// A component of position or velocity at every node.
class ComponentField : public RodField {
 public:
  ComponentField(Vector State::* values, int component, const RodLayout& rod, const Model& model)
      : RodField(rod.arc_length), values_(values) {
    for (const Index node : rod.nodes) dofs_.push_back(model.dof(node, component));
  }
  [[nodiscard]] double sample(std::size_t i, const Model& /*model*/,
                              const State& state) const override {
    return (state.*values_)[dofs_[i]];
  }

 private:
  Vector State::* values_;
  std::vector<Index> dofs_;
};

class SpeedField : public RodField {
 public:
  SpeedField(const RodLayout& rod, const Model& model) : RodField(rod.arc_length) {
    for (const Index node : rod.nodes) dofs_.push_back(model.dof(node, 0));
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    return state.velocities.segment(dofs_[i], model.dimension).norm();
  }

 private:
  std::vector<Index> dofs_;  // of the first component
};

std::string quantities_along_rods() {
  std::string names;
  for (const Quantity& quantity : quantities()) {
    if (quantity.kind == QuantityKind::Energy) continue;
    names += (names.empty() ? "" : ", ") + quantity.name;
  }
  return names;
}

}  // namespace

std::unique_ptr<RodField> make_rod_field(const std::string& quantity, const RodLayout& rod,
                                         const Model& model) {
  const auto component = [&](Vector State::* values, int number) {
    return std::make_unique<ComponentField>(values, number, rod, model);
  };
  if (quantity == "x") return component(&State::positions, 0);
  if (quantity == "y") return component(&State::positions, 1);
  if (quantity == "vx") return component(&State::velocities, 0);
  if (quantity == "vy") return component(&State::velocities, 1);
  if (quantity == "speed") return std::make_unique<SpeedField>(rod, model);
  if (quantity == "strain") return make_stretch_field(1.0, rod, model);
  if (quantity == "tension") return make_stretch_field(rod.EA, rod, model);
  if (quantity == "turning_angle" || quantity == "curvature" || quantity == "moment") {
    return make_bend_field(quantity, rod, model);
  }
  throw Error("model_error", fmt::format("'{}' is not a quantity along a rod; these are: {}",
                                         quantity, quantities_along_rods()));
}

}  // namespace der
