#include "der/output/out_of_plane_verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "der/scenario/scenario.hpp"

namespace der {
namespace {

/// Load factors that differ by a smaller share are the same: they come from two models, and
/// rounding decides which is lower.
constexpr double kSameLoad = 1e-6;

constexpr const char* kAdvice =
    "Supports are taken to hold z and the section there. To follow the rod out of the plane, write "
    "'model: spatial', draw a node in its middle a millionth of its length off the plane, and let "
    "the supports hold z ('clamp: true' holds the section, too)";

std::string directions(Index count) {
  return fmt::format("{} {}", count, count == 1 ? "direction" : "directions");
}

/// The first point of the first branch from which on there are unstable directions out of the
/// plane, or rounding hides whether there are; null if there is none.
const PathPoint* leaves_plane_at(const std::vector<PathBranch>& path) {
  if (path.empty()) return nullptr;
  const auto& points = path.front().points;
  const auto first = std::find_if(points.begin(), points.end(), [](const PathPoint& point) {
    const Stability& stability = point.out_of_plane;
    return stability.unstable_directions + stability.unknown_directions > 0;
  });
  return first == points.end() ? nullptr : &*first;
}

/// One overload for each kind of analysis.
struct Judge {
  const RunOutcome& outcome;
  OutOfPlaneVerdict& verdict;

  void operator()(const scenario::DynamicAnalysis& /*analysis*/) const {}
  void operator()(const scenario::StaticAnalysis& /*analysis*/) const { of_equilibrium(""); }
  void operator()(const scenario::ModesAnalysis& /*analysis*/) const {
    verdict.growth_rate = outcome.out_of_plane.growth_rate;
    const double rate = verdict.growth_rate;
    of_equilibrium(rate > 0.0 ? fmt::format(", where a motion grows by {:.4g}/s", rate) : "");
  }
  void operator()(const scenario::BucklingAnalysis& /*analysis*/) const {
    verdict.not_tested = outcome.out_of_plane.buckling.not_tested;
    verdict.load_factor = outcome.out_of_plane.buckling.load_factor;
    if (!verdict.load_factor) return;
    const auto& modes = outcome.buckling.modes;
    if (!modes.empty()) {
      const double in_plane = modes.front().load_factor;
      if (*verdict.load_factor >= in_plane - kSameLoad * std::abs(in_plane)) return;
    }
    if (*verdict.load_factor == 0.0) {
      verdict.warning =
          "the structure leaves its plane under any load: nothing resists a motion out of it that "
          "the loads drive. Hold the rods with more supports";
      return;
    }
    verdict.warning = fmt::format(
        "the structure buckles out of its plane first, at the load factor {:.6g}. For the shape, "
        "write 'model: spatial', and let the supports hold z",
        *verdict.load_factor);
  }
  void operator()(const scenario::ContinuationAnalysis& /*analysis*/) const {
    const PathPoint* point = leaves_plane_at(outcome.path);
    if (point == nullptr) return;
    if (point->out_of_plane.unknown_directions > 0) {
      verdict.not_tested = fmt::format(
          "from the load factor {:.6g} on, rounding hides whether the path is stable out of its "
          "plane: its shortest edges are too short",
          point->factor);
      return;
    }
    verdict.load_factor = point->factor;
    verdict.warning = fmt::format(
        "the path leaves its plane at the load factor {:.6g}: equilibria beyond it are unstable "
        "against motion out of the plane. {}",
        *verdict.load_factor, kAdvice);
  }

  void of_equilibrium(const std::string& growing) const {
    if (!outcome.equilibrium || !outcome.equilibrium->out_of_plane) return;
    verdict.stability = outcome.equilibrium->out_of_plane->stability;
    if (verdict.stability->unstable_directions == 0) return;
    verdict.warning = fmt::format(
        "{}{}. {}", in_and_out_of_plane(outcome.equilibrium->stability, *verdict.stability),
        growing, kAdvice);
  }
};

}  // namespace

std::optional<OutOfPlaneVerdict> out_of_plane_verdict(const Simulation& simulation,
                                                      const RunOutcome& outcome) {
  const scenario::Scene& scene = simulation.scenario().scene();
  if (scene.is_dynamic() || simulation.model().dimension != 2 || !outcome.ok()) return std::nullopt;
  OutOfPlaneVerdict verdict;
  verdict.not_tested = simulation.not_tested_out_of_plane();
  if (verdict.not_tested.empty()) std::visit(Judge{outcome, verdict}, scene.analysis);
  return verdict;
}

std::string in_and_out_of_plane(const Stability& in_plane, const Stability& out_of_plane) {
  std::string text =
      fmt::format("{} in its plane, {} out of it", in_plane.name(), out_of_plane.name());
  if (const Index count = out_of_plane.unstable_directions; count > 0) {
    text += ": " + directions(count);
  }
  return text;
}

}  // namespace der
