#include "output/rod_field.hpp"

#include <fmt/format.h>

#include "der/catalog/quantities.hpp"
#include "der/core/error.hpp"
#include "der/core/index.hpp"
#include "der/supports/clamp.hpp"
#include "output/bend_field.hpp"

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

std::vector<double> edge_middles(const RodLayout& rod) {
  std::vector<double> middles;
  for (std::size_t i = 1; i < rod.arc_length.size(); ++i) {
    middles.push_back(0.5 * (rod.arc_length[i - 1] + rod.arc_length[i]));
  }
  return middles;
}

/// Strain of every edge, times a stiffness (1 for the strain itself, EA for the tension).
class StretchField : public RodField {
 public:
  StretchField(double stiffness, const RodLayout& rod, const Model& model)
      : RodField(edge_middles(rod)), stiffness_(stiffness), edge_length_(rod.edge_length) {
    for (Index edge = 0; edge < rod.num_edges(); ++edge) {
      links_.push_back(link_of(rod, edge, model));
      rest_length_.push_back(links_.back().vector(model.initial_positions, 0.0, 0.0).norm());
    }
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    const double length = link_vector(links_[i], model, state).norm();
    return stiffness_ * (length - rest_length_[i]) / edge_length_[i];
  }

 private:
  double stiffness_;
  std::vector<double> edge_length_;
  std::vector<double> rest_length_;  // of the links
  std::vector<Link> links_;
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
  if (quantity == "strain") return std::make_unique<StretchField>(1.0, rod, model);
  if (quantity == "tension") return std::make_unique<StretchField>(rod.EA, rod, model);
  if (quantity == "turning_angle" || quantity == "curvature" || quantity == "moment") {
    return make_bend_field(quantity, rod, model);
  }
  throw Error("model_error", fmt::format("'{}' is not a quantity along a rod; these are: {}",
                                         quantity, quantities_along_rods()));
}

}  // namespace der
