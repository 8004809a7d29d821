#include "output/motion_field.hpp"

#include <cmath>

namespace der {
namespace {

class ComponentField : public RodField {
 public:
  ComponentField(Vector State::* vector, int component, const RodLayout& rod, const Model& model)
      : RodField(rod.arc_length), vector_(vector) {
    for (const Index node : rod.nodes) dofs_.push_back(model.dof(node, component));
  }
  [[nodiscard]] double sample(std::size_t i, const Model& /*model*/,
                              const State& state) const override {
    return (state.*vector_)[dofs_[i]];
  }

 private:
  Vector State::* vector_;
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
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    double squared = 0.0;
    for (int c = 0; c < model.dimension; ++c) {
      double component = 0.0;
      for (const auto& [sample, weight] : weights) {
        component += weight * state.velocities[dofs_[sample] + c];
      }
      squared += component * component;
    }
    return std::sqrt(squared);
  }

 private:
  std::vector<Index> dofs_;  // of the first component
};

}  // namespace

std::unique_ptr<RodField> make_component_field(Vector State::* vector, int component,
                                               const RodLayout& rod, const Model& model) {
  return std::make_unique<ComponentField>(vector, component, rod, model);
}

std::unique_ptr<RodField> make_speed_field(const RodLayout& rod, const Model& model) {
  return std::make_unique<SpeedField>(rod, model);
}

}  // namespace der
