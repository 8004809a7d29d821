#include "statics/equilibrium/winding.hpp"

#include <cmath>

#include "der/core/constants.hpp"
#include "der/kinematics/planar_edge.hpp"
#include "der/supports/clamp.hpp"
#include "supports/leg_clamp.hpp"

namespace der::statics {
namespace {

double tangent_angle(const Clamp& clamp, const Configuration& here) {
  return clamp.direction + (clamp.rotation >= 0 ? here.controls[clamp.rotation] : 0.0);
}

/// Sum of the turning angles [rad] at all nodes from one clamp to another, both included.
double turning_angle(const Model& model, const RodMesh& rod, const Clamp& first, const Clamp& last,
                     const Configuration& here) {
  const auto tangent = [&](const Clamp& clamp) {
    const double angle = tangent_angle(clamp, here);
    return Vec2(std::cos(angle), std::sin(angle));
  };
  double sum = 0.0;
  Vec2 before = tangent(first);
  for (Index edge = first.place; edge < last.place; ++edge) {
    const EffectiveEdge effective = effective_edge(rod, edge, model);
    const Vec2 next = effective.vector(here);
    sum += angle_between(before, next);
    before = next;
  }
  return sum + angle_between(before, tangent(last));
}

}  // namespace

std::vector<double> planar_whole_turns(const Model& model, const Configuration& here) {
  std::vector<double> turns;
  if (model.dimension != 2) return turns;
  for (const RodMesh& rod : model.rods) {
    for (const Clamp& first : rod.clamps) {
      for (const Clamp& other : rod.clamps) {
        if (first.place >= other.place) continue;
        const Clamp last = clamp_of_leg(other, true, rod, model);
        const double between = turning_angle(model, rod, first, last, here) -
                               tangent_angle(last, here) + tangent_angle(first, here);
        turns.push_back(std::round(between / (2.0 * kPi)));
      }
    }
  }
  return turns;
}

}  // namespace der::statics
