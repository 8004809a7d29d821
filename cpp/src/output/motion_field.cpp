#include "output/motion_field.hpp"

#include <algorithm>
#include <limits>

#include "model/corner.hpp"
#include "output/dip.hpp"
#include "output/leg_field.hpp"

namespace der {
namespace {

/// A field at the nodes, with a kink at the corners.
class NodeField : public RodField {
 public:
  NodeField(const RodMesh& rod, const Model& model)
      : RodField(rod.arc_length), corners_(corners_of(rod, model)) {}
  [[nodiscard]] bool smooth_at(std::size_t i) const override {
    return !std::binary_search(corners_.begin(), corners_.end(), static_cast<Index>(i));
  }

 private:
  std::vector<Index> corners_;
};

class ComponentField : public NodeField {
 public:
  ComponentField(Vector State::* vector, int component, const RodMesh& rod, const Model& model)
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
  SpeedField(const RodMesh& rod, const Model& model) : NodeField(rod, model), closed_(rod.closed) {
    for (const Index node : rod.nodes) dofs_.push_back(model.dof(node, 0));
  }
  [[nodiscard]] double sample(std::size_t i, const Model& model,
                              const State& state) const override {
    return velocity(i, model, state).norm();
  }
  [[nodiscard]] double interpolate(const SampleWeights& weights, const Model& model,
                                   const State& state) const override {
    Vec3 sum = Vec3::Zero();
    for (const auto& [sample, weight] : weights) sum += weight * velocity(sample, model, state);
    return sum.norm();
  }
  [[nodiscard]] double dip(const Model& model, const State& state) const override {
    double least = std::numeric_limits<double>::infinity();
    Vec3 before = velocity(closed_ ? dofs_.size() - 1 : 0, model, state);
    for (std::size_t i = closed_ ? 0 : 1; i < dofs_.size(); ++i) {
      const Vec3 here = velocity(i, model, state);
      least = std::min(least, min_norm_on_segment(before, here));
      before = here;
    }
    return least;
  }

 private:
  [[nodiscard]] Vec3 velocity(std::size_t i, const Model& model, const State& state) const {
    Vec3 velocity = Vec3::Zero();
    velocity.head(model.dimension) = state.velocities.segment(dofs_[i], model.dimension);
    return velocity;
  }

  bool closed_;
  std::vector<Index> dofs_;  // of the first component
};

}  // namespace

std::unique_ptr<RodField> make_component_field(Vector State::* vector, int component,
                                               const RodMesh& rod, const Model& model) {
  if (vector == &State::positions && !rod.legs.empty() && model.dimension == 2) {
    return make_leg_place_field(component, rod, model);
  }
  return std::make_unique<ComponentField>(vector, component, rod, model);
}

std::unique_ptr<RodField> make_speed_field(const RodMesh& rod, const Model& model) {
  return std::make_unique<SpeedField>(rod, model);
}

}  // namespace der
