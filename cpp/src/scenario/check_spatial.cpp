#include <variant>

#include "der/scenario/load.hpp"
#include "scenario/checks.hpp"

// All that the language of scenes has and this version does not compute. Remove a line when it
// does.

namespace der::scenario {
namespace {

class Availability {
 public:
  Availability(const SceneText& scene, Diagnostics& diagnostics)
      : scene_(scene), diagnostics_(diagnostics) {}

  /// What no model has.
  void check_all_models() {
    for_each_load([this](const auto& load, const Path& path) {
      if (turns_with_rod(load)) {
        not_available(path / "follower", "loads that turn with the rod");
      }
    });
  }

  /// What the planar model alone has.
  void check_spatial_models() {
    for (int i = 0; i < static_cast<int>(scene_.supports.size()); ++i) {
      if (scene_.supports[static_cast<std::size_t>(i)].spring) {
        only_planar({"supports", i, "spring"}, "springs");
      }
    }
    for_each_load([this](const auto& load, const Path& path) {
      using Kind = std::decay_t<decltype(load)>;
      if (std::is_same_v<Kind, Moment>) only_planar(path, "moments");
      if (std::is_same_v<Kind, Foundation>) only_planar(path, "foundations");
    });
    if (std::holds_alternative<BucklingAnalysis>(scene_.analysis)) {
      only_planar({"analysis"}, "buckling loads");
    }
    if (std::holds_alternative<ContinuationAnalysis>(scene_.analysis)) {
      only_planar({"analysis"}, "continuation");
    }
    if (scene_.is_dynamic() && scene_.time.integrator == "energy_momentum") {
      only_planar({"time", "integrator"}, "'energy_momentum'");
    }
  }

 private:
  template <class Load>
  static bool turns_with_rod(const Load& load) {
    if constexpr (std::is_same_v<Load, PointForce> || std::is_same_v<Load, Moment>) {
      return load.follower;
    }
    return false;
  }

  template <class F>
  void for_each_load(F&& f) {
    for (int i = 0; i < static_cast<int>(scene_.loads.size()); ++i) {
      std::visit([&](const auto& load) { f(load, Path{"loads", i, load.kKey}); },
                 scene_.loads[static_cast<std::size_t>(i)].what);
    }
  }

  void not_available(const Path& where, const std::string& what) {
    diagnostics_.add(where, what + " are not available yet");
  }
  void only_planar(const Path& where, const std::string& what) {
    diagnostics_.add(where, what + ": not available yet in the spatial models, only in 'planar'");
  }

  const SceneText& scene_;
  Diagnostics& diagnostics_;
};

}  // namespace

void check_availability(const SceneText& scene, ModelChoice kind, Diagnostics& diagnostics) {
  Availability availability(scene, diagnostics);
  availability.check_all_models();
  if (kind != ModelChoice::Planar) availability.check_spatial_models();
}

}  // namespace der::scenario
