#include "statics/equilibrium/polishing.hpp"

#include <limits>

#include "der/core/index.hpp"

namespace der::statics {
namespace {

constexpr int kMaxPolishingSteps = 8;
/// A step that moves a degree of freedom by more than this fraction of the size is not taken.
constexpr double kLongestStep = 1e-1;
/// The last step must be shorter than this fraction of the size.
constexpr double kAccepted = 1e-6;

/// Solves for a Newton step in place. Returns false if no step can be computed.
bool solve_for_step(Stiffness& stiffness, const Stability& stability, Vector& step) {
  if (stability.doubtful_directions > 0 && stability.unstable_directions == 0) {
    return stiffness.solve_by_elements(step);
  }
  if (!stiffness.factorize().factorised) return false;
  stiffness.solve(step);
  return true;
}

}  // namespace

bool polish(const Model& model, const Vector& force, const Stability& stability,
            Stiffness& stiffness, Configuration& here) {
  double length = std::numeric_limits<double>::infinity();
  Vector step;
  for (int i = 0; i < kMaxPolishingSteps; ++i) {
    step = (force - stiffness.gradient())(model.dofs.free());
    const bool solved = solve_for_step(stiffness, stability, step);
    const double next = solved ? model.dofs.largest_motion(over_all_dofs(model, step)) : length;
    if (!(next < 0.5 * length)) break;
    length = next;
    if (length > kLongestStep * model.size()) break;
    for (Index k = 0; k < model.num_free(); ++k)
      here.coordinates[model.dofs.free()[to_size(k)]] += step[k];
    stiffness.evaluate(here);
  }
  return length <= kAccepted * model.size();
}

}  // namespace der::statics
