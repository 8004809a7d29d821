#include "model/glue.hpp"

#include <algorithm>
#include <cmath>

namespace der {
namespace {

constexpr double kLeastGluedTurn = 1e-9;  // [rad]

}  // namespace

bool is_glued_turned(const RodJoint& joint) { return std::abs(joint.glued) > kLeastGluedTurn; }

bool meets_turned(const RodJoint& joint) { return joint.clamp < 0 && is_glued_turned(joint); }

bool turns_axes(const RodJoint& joint, const RodLayout& rod) {
  return meets_turned(joint) && std::abs(std::sin(joint.glued)) > kLeastGluedTurn &&
         rod.EI_1 != rod.EI_2;
}

bool parts_bending(const RodJoint& joint, const RodLayout& rod) {
  const auto& natural = rod.natural_curvatures;
  const auto is_curved = [](const Vec2& at) { return !at.isZero(0.0); };
  return turns_axes(joint, rod) ||
         (meets_turned(joint) && std::any_of(natural.begin(), natural.end(), is_curved));
}

}  // namespace der
