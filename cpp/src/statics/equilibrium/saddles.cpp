#include "statics/equilibrium/saddles.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "der/statics/potential.hpp"

namespace der::statics {
namespace {

/// Changes of an edge [rad] with which the saddle is left; the second if the first fails.
constexpr std::array<double, 2> kPerturbations{0.05, 0.001};
/// Changes of the potential that differ by less than this fraction are equal.
constexpr double kSameChange = 1e-6;

}  // namespace

Vector unit_displacement(const Model& model, const SoftDirection& soft) {
  const Vector displacement = over_all_dofs(model, soft.direction);
  return displacement / largest_edge_change(model, displacement);
}

bool leave_saddle(const Model& model, const StaticLoads& loads, const StaticNewton& newton,
                  PseudoTransient& continuation, Stiffness& stiffness, Shape& shape) {
  stiffness.evaluate(loads.at(model, shape));
  const SoftDirection soft = stiffness.softest();
  const Vector direction = unit_displacement(model, soft);
  const double inverse_step = 2.0 * std::abs(soft.curvature);
  for (const double perturbation : kPerturbations) {
    std::optional<Shape> best;
    double best_change = -newton.energy_resolution();
    for (const double side : {1.0, -1.0}) {
      Shape here{shape.positions + side * perturbation * direction, shape.followed};
      const double push = energy_change(model, loads, shape, shape.positions, here.positions);
      const PseudoTransient::Result result =
          continuation.run(loads, inverse_step, here, PseudoTransient::kDecayAtSaddle);
      if (result.failed) continue;
      const double change = push + result.energy_change;
      if (change < best_change - kSameChange * std::abs(best_change)) {
        best = std::move(here);
        best_change = change;
      }
    }
    if (best) {
      shape = *std::move(best);
      return true;
    }
  }
  return false;
}

}  // namespace der::statics
