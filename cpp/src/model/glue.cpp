#include "model/glue.hpp"

#include <algorithm>
#include <cmath>

namespace der {
namespace {

constexpr double kLeastGluedTurn = 1e-9;  // [rad]

}  // namespace

bool is_glued_turned(const RodVertex& vertex) { return std::abs(vertex.glued) > kLeastGluedTurn; }

bool meets_turned(const RodVertex& vertex) { return vertex.clamp < 0 && is_glued_turned(vertex); }

bool turns_axes(const RodVertex& vertex, const RodMesh& rod) {
  return meets_turned(vertex) && std::abs(std::sin(vertex.glued)) > kLeastGluedTurn &&
         rod.EI_1 != rod.EI_2;
}

bool parts_bending(const RodVertex& vertex, const RodMesh& rod) {
  const auto& natural = rod.natural_curvatures;
  const auto is_curved = [](const Vec2& at) { return !at.isZero(0.0); };
  return turns_axes(vertex, rod) ||
         (meets_turned(vertex) && std::any_of(natural.begin(), natural.end(), is_curved));
}

}  // namespace der
