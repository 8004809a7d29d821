#include "der/statics/load_path.hpp"

#include "der/building/builder.hpp"
#include "der/core/index.hpp"

namespace der {
namespace {

void erase(scenario::Series& series) {
  for (double& value : series.values) value = 0.0;
}

void erase(scenario::VectorSeries& series) {
  for (auto& value : series.values) value.assign(value.size(), 0.0);
}

/// Sets a load to zero without taking it away, so that the model keeps its tables.
struct EraseLoad {
  void operator()(scenario::Gravity& load) const {
    load.acceleration.assign(load.acceleration.size(), 0.0);
  }
  void operator()(scenario::Fluid& /*load*/) const {}  // buoyancy goes with gravity
  void operator()(scenario::Damping& /*load*/) const {}
  void operator()(scenario::PointForce& load) const { erase(load.force); }
  void operator()(scenario::Moment& load) const { erase(load.moment); }
  void operator()(scenario::DistributedForce& load) const { erase(load.force); }
};

void erase(scenario::Support& support) {
  for (auto& prescribed : support.prescribe) erase(prescribed.displacement);
  if (support.rotation) erase(*support.rotation);
}

scenario::Scene without(scenario::Scene scene, scenario::Varied varied, std::optional<int> number) {
  const auto chosen = [&](std::size_t i) { return !number || at(*number) == i; };
  if (varied == scenario::Varied::Loads) {
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
      if (chosen(i)) std::visit(EraseLoad{}, scene.loads[i].what);
    }
  } else {
    for (std::size_t i = 0; i < scene.supports.size(); ++i) {
      if (chosen(i)) erase(scene.supports[i]);
    }
  }
  return scene;
}

}  // namespace

LoadPath::LoadPath(const scenario::Scene& scene, const Model& model, scenario::Varied varied,
                   std::optional<int> number)
    : gravity1_(model.gravity_force),
      dead1_(model.dead_force),
      linear_(varied == scenario::Varied::Loads) {
  const Model unloaded = build_model(without(scene, varied, number));
  gravity0_ = unloaded.gravity_force;
  dead0_ = unloaded.dead_force;
  unloaded.controls.evaluate(0.0, controls0_);
  model.controls.evaluate(0.0, controls1_);
}

void LoadPath::apply(double factor, Model& model) const {
  model.gravity_force = gravity0_ + factor * (gravity1_ - gravity0_);
  model.dead_force = dead0_ + factor * (dead1_ - dead0_);
  for (Index i = 0; i < model.controls.size(); ++i) {
    model.controls.set_constant(i, controls0_[i] + factor * (controls1_[i] - controls0_[i]));
  }
}

}  // namespace der
