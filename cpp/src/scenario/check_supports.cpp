#include "scenario/checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "scenario/directions.hpp"

namespace der::scenario {
namespace {

std::vector<Hold> held_by(const Support& support) {
  std::vector<Hold> held;
  if (support.clamps()) {
    for (const Component component : {Component::X, Component::Y, Component::Z}) {
      if (support.clamps(component)) held.push_back(hold_of(component));
    }
    held.push_back(Hold::Angle);
    return held;
  }
  for (const Component component : support.fix) held.push_back(hold_of(component));
  for (const Prescribed& motion : support.prescribe) held.push_back(hold_of(motion.component));
  std::sort(held.begin(), held.end());
  return held;
}

/// A run over time begins with the initial shape, where every prescribed motion is 0.
void check_start(CheckContext& context, const Series& motion, const Path& path) {
  if (!context.scene.is_dynamic() || !context.scene.start_from.empty()) return;
  const double start = value_at(motion, 0.0);
  // A sine that begins at 0 does so but for the rounding of its amplitude.
  const bool is_sine = motion.course.kind == Course::Kind::Sine;
  if (std::abs(start) <= (is_sine ? 1e-14 * std::abs(motion.values[1]) : 0.0)) return;
  context.diagnostics.add(
      path,
      fmt::format("is {:g} at time 0, where the rods are as drawn: the run would begin with a "
                  "jump. Give a table that begins with 0, as {{times: [0, 1], values: [0, "
                  "{:g}]}}, or begin at rest with 'start_from: equilibrium'",
                  start, start));
}

/// The nodes that a joint joins with one are held with it.
void hold_joined(CheckContext& context, int number, std::int64_t node,
                 const std::vector<Hold>& held) {
  const auto found = context.joined.find(node);
  if (found == context.joined.end()) return;
  for (const std::int64_t other : found->second.others) {
    for (const Hold component : held) {
      if (component == Hold::Angle && !found->second.rigid) continue;
      context.held[other].enter(component, number);
    }
  }
}

/// Enters what a support holds of its nodes; reports once where another holds it already.
void hold(CheckContext& context, int number, int rod, const std::vector<int>& nodes) {
  const Support& support = context.scene.supports[static_cast<std::size_t>(number)];
  const std::vector<Hold> held = held_by(support);
  for (const int node : nodes) {
    HeldNode& holding = context.held[CheckContext::node_key(rod, node)];
    for (const Hold component : held) {
      if (const std::optional<int> other = holding.holder(component)) {
        const int line = context.scene.supports[static_cast<std::size_t>(*other)].mark.line;
        context.diagnostics.add(
            {"supports", number},
            fmt::format("{} of node {} of rod '{}' is already held by support {}{}",
                        name_of(component), node, support.rod, *other,
                        line > 0 ? fmt::format(" (line {})", line) : std::string()));
        return;
      }
      holding.enter(component, number);
    }
    hold_joined(context, number, CheckContext::node_key(rod, node), held);
  }
}

void check_support(CheckContext& context, int number) {
  const Path path{"supports", number};
  if (context.diagnostics.under(path)) return;
  Support& support = context.scene.supports[static_cast<std::size_t>(number)];
  for (const Prescribed& motion : support.prescribe) {
    check_motion(context, motion.displacement, path / "prescribe" / name_of(motion.component));
  }
  if (support.rotation) {
    const Path key = path / "prescribe" / "angle";
    check_motion(context, *support.rotation, key);
    if (context.diagnostics.dimension() == 3) {
      context.diagnostics.add(key,
                              "in a scene of three components a clamp turns about an axis: write "
                              "'rotation: {axis: [0, 0, 1], angle: ...}'");
    }
  }
  if (support.axis_rotation) {
    check_motion(context, support.axis_rotation->angle, path / "prescribe" / "rotation" / "angle");
  }
  if (support.twist) check_motion(context, *support.twist, path / "prescribe" / "twist");
  if (context.diagnostics.dimension() == 2 && support.clamps() && !support.clamps(Component::Z)) {
    context.diagnostics.add(path / "free", "a scene of two components has no z: remove it");
  }
  const std::optional<int> rod = context.find_rod(support.rod, path / "rod");
  if (!rod) return;
  const auto nodes = context.nodes_at(*rod, support.at, path / "at", support.holds());
  if (nodes && support.holds()) hold(context, number, *rod, *nodes);
}

/// Reports a spring on a held component, or against turning of a rod that does not bend.
void check_spring(CheckContext& context, int number) {
  const Path path{"supports", number};
  Support& support = context.scene.supports[static_cast<std::size_t>(number)];
  if (!support.spring || context.diagnostics.under(path)) return;
  const std::optional<int> rod = context.find_rod(support.rod, path / "rod");
  if (!rod) return;
  const Path here = path / "spring";
  if (support.at.kind == Location::Kind::All) {
    context.diagnostics.add(path / "at", "'all' is not a single place, and a spring holds one");
    return;
  }
  const bool turns = !support.spring->rotational_stiffness.empty();
  if (turns && does_not_bend(context.scene.rods[static_cast<std::size_t>(*rod)])) {
    context.diagnostics.add(here / "rotational_stiffness",
                            "the rod has no stiffness against bending, EI: nothing turns it");
  }
  const auto nodes = context.nodes_at(*rod, support.at, path / "at", false);
  if (!nodes || nodes->empty()) return;
  const HeldNode* held = context.held_at(*rod, nodes->front());
  if (!held) return;
  const auto report_if_held = [&](Hold component, const char* key) {
    const std::optional<int> holder = held->holder(component);
    if (!holder) return;
    context.diagnostics.add(
        here / key, fmt::format("{} of node {} of rod '{}' is held by support {}: a spring has no "
                                "effect there",
                                name_of(component), nodes->front(), support.rod, *holder));
  };
  const Components& stiffness = support.spring->stiffness;
  constexpr std::array axes{Hold::X, Hold::Y, Hold::Z};
  for (std::size_t c = 0;
       c < std::min(static_cast<std::size_t>(context.dimension), stiffness.size()); ++c) {
    if (stiffness[c] > 0.0) report_if_held(axes[c], "stiffness");
  }
  if (!turns) return;
  const Support* clamp = context.clamp_at(*rod, nodes->front());
  if (context.dimension == 3 && clamp != nullptr && clamp->clamp == Clamp::Tangent) {
    context.diagnostics.add(
        here / "rotational_stiffness",
        fmt::format("'clamp: tangent' holds the tangent at node {} of rod '{}', and a spring "
                    "against turning has to be at another place, one about the tangent, too: a "
                    "quarter of an edge from the node, say",
                    nodes->front(), support.rod));
    return;
  }
  report_if_held(Hold::Angle, "rotational_stiffness");
}

}  // namespace

void check_constant(CheckContext& context, bool constant, const Path& path) {
  if (constant || context.scene.is_dynamic()) return;
  context.diagnostics.add(path,
                          "a static analysis has no time: give a constant in place of a table");
}

void check_motion(CheckContext& context, const Series& motion, const Path& path) {
  check_constant(context, motion.constant(), path);
  check_start(context, motion, path);
}

void check_supports(CheckContext& context) {
  const auto count = static_cast<int>(context.scene.supports.size());
  for (int i = 0; i < count; ++i) check_support(context, i);
}

void warn_of_turned_damping(CheckContext& context) {
  constexpr std::array accurate{"sdirk4", "generalized_alpha"};
  Scene& scene = context.scene;
  const std::string& integrator = scene.time.integrator;
  if (!scene.is_dynamic() ||
      std::find(accurate.begin(), accurate.end(), integrator) != accurate.end()) {
    return;
  }
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const Support& support = scene.supports[i];
    const auto rod = std::find_if(scene.rods.begin(), scene.rods.end(),
                                  [&](const Rod& other) { return other.name == support.rod; });
    const bool turns = support.rotation || support.axis_rotation || support.twist;
    if (!turns || !damping_of(*rod).any()) continue;
    scene.warnings.push_back(fmt::format(
        "support {} rotates rod '{}', which has internal damping. With '{}' the moments and forces "
        "next to it may take shorter steps than the motion: write 'integrator: sdirk4', or see "
        "their errors with 'der verify'",
        i, rod->name, integrator));
    return;
  }
}

void check_springs(CheckContext& context) {
  const auto count = static_cast<int>(context.scene.supports.size());
  for (int i = 0; i < count; ++i) check_spring(context, i);
}

}  // namespace der::scenario
