#include "der/statics/load_path.hpp"

#include "der/building/builder.hpp"
#include "der/core/index.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Keeps the supports where they are drawn, and the tables of the model.
void hold_still(scenario::Support& support) {
  for (auto& prescribed : support.prescribe) set_to_zero(prescribed.displacement);
  if (support.rotation) set_to_zero(*support.rotation);
}

scenario::Scene without(scenario::Scene scene, scenario::Varied varied, std::optional<int> number) {
  const auto chosen = [&](std::size_t i) { return !number || at(*number) == i; };
  if (varied == scenario::Varied::Loads) {
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
      if (chosen(i)) set_to_zero(scene.loads[i]);
    }
  } else {
    for (std::size_t i = 0; i < scene.supports.size(); ++i) {
      if (chosen(i)) hold_still(scene.supports[i]);
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
