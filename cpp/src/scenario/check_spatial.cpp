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

  /// Some loads have no potential, and some analyses need one.
  void check_potential(ModelChoice kind) {
    const char* analysis =
        std::holds_alternative<ModesAnalysis>(scene_.analysis)          ? "modes"
        : std::holds_alternative<BucklingAnalysis>(scene_.analysis)     ? "buckling loads"
        : std::holds_alternative<ContinuationAnalysis>(scene_.analysis) ? "paths of equilibria"
                                                                        : nullptr;
    if (analysis == nullptr) return;
    for_each_load([&](const auto& load, const Path& path) {
      if (!is_circulatory(load, kind)) return;
      diagnostics_.add(path, std::string(analysis) +
                                 " are those of a potential, and this load has none, since it "
                                 "turns with the rod or is a moment in space: write 'analysis: "
                                 "static', or run over time");
    });
  }

  /// The discrete gradients of `energy_momentum` are those of angles in a plane.
  void check_spatial_models() {
    if (scene_.is_dynamic() && scene_.time.integrator == "energy_momentum") {
      diagnostics_.add({"time", "integrator"},
                       "'energy_momentum' is for the planar model only: it keeps the energy of "
                       "turning angles in a plane. Write 'implicit_midpoint', which keeps momenta, "
                       "or 'sdirk5' with a 'tolerance'");
    }
  }

 private:
  template <class Load>
  static bool is_circulatory(const Load& load, ModelChoice kind) {
    if constexpr (std::is_same_v<Load, PointForce>) return load.follower;
    return std::is_same_v<Load, Moment> && kind != ModelChoice::Planar;
  }

  template <class F>
  void for_each_load(F&& f) {
    for (int i = 0; i < static_cast<int>(scene_.loads.size()); ++i) {
      std::visit([&](const auto& load) { f(load, Path{"loads", i, load.kKey}); },
                 scene_.loads[static_cast<std::size_t>(i)].what);
    }
  }

  const SceneText& scene_;
  Diagnostics& diagnostics_;
};

}  // namespace

void check_availability(const SceneText& scene, ModelChoice kind, Diagnostics& diagnostics) {
  Availability availability(scene, diagnostics);
  availability.check_potential(kind);
  if (kind != ModelChoice::Planar) availability.check_spatial_models();
}

}  // namespace der::scenario
