#include "building/load_variation.hpp"

#include <utility>
#include <variant>

#include "der/building/builder.hpp"
#include "der/core/index.hpp"
#include "der/scenario/joint.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/model_choice.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Sets the prescribed motions of a support to zero, but keeps their tables in the model.
void hold_still(scenario::Support& support) {
  scenario::for_each_motion(
      support, [](const char* /*key*/, scenario::Series& motion) { set_to_zero(motion); });
}

void release(scenario::Actuation& actuation) {
  for (scenario::Series& value : actuation.values) set_to_zero(value);
}

/// The quantities that the load factor of a scene scales.
struct Varying {
  scenario::Varied what = scenario::Varied::Loads;
  std::optional<int> number;  // of the one load, support or actuation; none: all
};

std::optional<Varying> varying(const scenario::Analysis& analysis) {
  if (const auto* path = std::get_if<scenario::ContinuationAnalysis>(&analysis)) {
    return Varying{path->vary, path->number};
  }
  if (std::holds_alternative<scenario::BucklingAnalysis>(analysis)) return Varying{};
  return std::nullopt;
}

/// The scene at the factor 0, as a scene without a load factor. It keeps the model, for which
/// another one may do without its loads.
scenario::Scene without(scenario::Scene scene, const Varying& varying) {
  const scenario::ModelChoice kind = scenario::choose_model(scene).kind;
  const auto chosen = [&](std::size_t i) {
    return !varying.number || to_size(*varying.number) == i;
  };
  if (varying.what == scenario::Varied::Loads) {
    for (std::size_t i = 0; i < scene.loads.size(); ++i) {
      if (chosen(i)) set_to_zero(scene.loads[i]);
    }
  } else if (varying.what == scenario::Varied::Supports) {
    for (std::size_t i = 0; i < scene.supports.size(); ++i) {
      if (chosen(i)) hold_still(scene.supports[i]);
    }
    for (scenario::Joint& joint : scene.joints) {
      if (joint.prescribe && !varying.number) set_to_zero(joint.prescribe->angle);
    }
  } else {
    for (std::size_t i = 0; i < scene.actuations.size(); ++i) {
      if (chosen(i)) release(scene.actuations[i]);
    }
  }
  scene.analysis = scenario::StaticAnalysis{};
  scene.model = kind;
  return scene;
}

LinearInFactor between(const Vector& at_zero, const Vector& at_one) {
  return {at_zero, at_one - at_zero};
}

}  // namespace

std::optional<LoadVariation> load_variation(const scenario::Scene& scene, const Model& model) {
  const auto what = varying(scene.analysis);
  if (!what) return std::nullopt;
  const Model unloaded = build_model(without(scene, *what));
  Vector controls_at_zero;
  Vector controls_at_one;
  unloaded.tables.evaluate(0.0, controls_at_zero);
  model.tables.evaluate(0.0, controls_at_one);
  unloaded.natural_strain.enter(controls_at_zero);
  model.natural_strain.enter(controls_at_one);
  return LoadVariation{between(unloaded.gravity_force, model.gravity_force),
                       between(unloaded.dead_force, model.dead_force),
                       between(controls_at_zero, controls_at_one),
                       what->what == scenario::Varied::Loads};
}

}  // namespace der
