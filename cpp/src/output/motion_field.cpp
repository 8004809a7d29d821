#include "output/motion_field.hpp"
#include "model/corner.hpp"

#include <algorithm>
#include <cmath>

namespace der {
namespace {

/// A field at the nodes, with a kink at the corners.
class NodeField : public RodField {
 public:
  NodeField(const RodLayout& rod, const Model& model)
      : RodField(rod.arc_length), corners_(corners_of(rod, model)) {}
  [[nodiscard]] bool smooth_at(std::size_t i) const override {
    return !std::binary_search(corners_.begin(), corners_.end(), static_cast<Index>(i));
  }

 private:
  std::vector<Index> corners_;
};

class ComponentField : public NodeField {
 public:
  ComponentField(Vector State::* vector, int component, const RodLayout& rod, const Model& model)
      : NodeField(rod, model), vector_(vector) {
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

class SpeedField : public NodeField {
 public:
  SpeedField(const RodLayout& rod, const Model& model) : NodeField(rod, model) {
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
