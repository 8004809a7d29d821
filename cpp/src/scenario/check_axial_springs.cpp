#include <algorithm>
#include <cmath>

#include "scenario/checks.hpp"
#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

/// Joints closer than this share of a rod at one of them are at one point, by rounding.
constexpr double kOnePoint = 1e-9;

/// A joint's place as drawn.
struct DrawnJoint {
  Components point;
  double rod_length = 0.0;  ///< [m] of a rod there
};

DrawnJoint drawn(const Joint& joint, const CheckContext& context) {
  const JointMember& member = joint.of.front();
  const auto rod = static_cast<std::size_t>(context.rods.at(member.rod));
  const RestLine& line = *context.lines[rod];
  const auto node = static_cast<std::size_t>(*line.node_at(line.arc_length_of(member.at)));
  return {context.scene.rods[rod].points[node], line.length()};
}

void check_rest_length(const Series& length, const Path& path, CheckContext& context) {
  check_constant(context, length.constant(), path);
  const bool is_sine = length.course.kind == Course::Kind::Sine;
  const double least = is_sine ? length.values[0] - std::abs(length.values[1])
                               : *std::min_element(length.values.begin(), length.values.end());
  if (least >= 0.0) return;
  context.diagnostics.add(path, fmt::format("comes to {:g} m, and no length is below 0", least));
}

void check(int number, CheckContext& context) {
  const AxialSpring& spring = context.scene.springs[static_cast<std::size_t>(number)];
  const Path path{"springs", number};
  if (context.diagnostics.under(path)) return;
  if (spring.stiffness == 0.0 && spring.damping == 0.0) {
    context.diagnostics.add(path / "stiffness",
                            "0 without a 'damping' does nothing: write a stiffness in N/m");
  }
  if (spring.rest_length) check_rest_length(*spring.rest_length, path / "rest_length", context);
  if (spring.between.size() != 2) {
    context.diagnostics.add(path / "between", fmt::format("a spring is between two joints, and "
                                                          "here are {} names",
                                                          spring.between.size()));
    return;
  }
  const Joint* first = find_joint(context, spring.between[0], path / "between" / 0);
  const Joint* second = find_joint(context, spring.between[1], path / "between" / 1);
  if (first == nullptr || second == nullptr) return;
  if (first == second) {
    context.diagnostics.add(path / "between",
                            fmt::format("joint '{}' is there twice: name another", first->name));
    return;
  }
  if (context.diagnostics.under({"joints"})) return;
  const DrawnJoint a = drawn(*first, context);
  const DrawnJoint b = drawn(*second, context);
  if (distance(a.point, b.point) > kOnePoint * std::max(a.rod_length, b.rod_length)) return;
  if (spring.rest_length && spring.rest_length->constant() && is_zero(*spring.rest_length)) return;
  context.diagnostics.add(
      path / (spring.rest_length ? "rest_length" : "between"),
      fmt::format("joints '{}' and '{}' are drawn at one point, so that the spring has no "
                  "direction: write 'rest_length: 0', or draw them apart",
                  first->name, second->name));
}

}  // namespace

void check_axial_springs(CheckContext& context) {
  for (int i = 0; i < static_cast<int>(context.scene.springs.size()); ++i) check(i, context);
}

}  // namespace der::scenario
