#include <algorithm>

#include "scenario/axis_stiffness.hpp"
#include "scenario/scene_text.hpp"
#include "scenario/suggestion.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

struct PrescribeText {
  std::optional<Series> x;
  std::optional<Series> y;
  std::optional<Series> angle;
};

struct SupportText : Support {
  PrescribeText motion;
};

Format<Component> component_format() {
  return choice<Component>(
      {{{"x", "horizontal"}, Component::X}, {{"y", "vertical"}, Component::Y}},
      {{"z", kNoSpatialRods}, {"angle", "to hold the direction of the rod write 'clamp: true'"}});
}

Format<PrescribeText> prescribe_format() {
  return mapping(
      Table<PrescribeText>("prescribed motion",
                           "Displacements from the initial position and the "
                           "rotation of a clamp, over time.")
          .optional("x", &PrescribeText::x, series("m"), "Horizontal displacement.")
          .optional("y", &PrescribeText::y, series("m"), "Vertical displacement.")
          .optional("angle", &PrescribeText::angle, series("rad"),
                    "Rotation of the clamped tangent, positive counter-clockwise; only with "
                    "`clamp: true`."));
}

Format<Spring> spring_format() {
  return mapping(
      Table<Spring>("spring", "An elastic support.")
          .optional("stiffness", &Spring::stiffness, axis_stiffness("N/m"),
                    "Force per displacement from the anchor: one number, or one each along x and "
                    "y, of which one may be 0.",
                    "none")
          .optional("anchor", &Spring::anchor, vector("m"),
                    "Where the place is without a force of the spring.",
                    "where the place is as drawn")
          .optional("rotational_stiffness", &Spring::rotational_stiffness,
                    number("N m/rad", positive()),
                    "Moment per angle between the rod's tangent and its drawn direction.", "none")
          .check([](Spring& spring, const Place& place, Diagnostics& diagnostics) {
            if (spring.stiffness.empty() && spring.rotational_stiffness == 0.0) {
              diagnostics.add(place, "give 'stiffness', 'rotational_stiffness' or both");
            } else if (spring.stiffness.empty() && !spring.anchor.empty()) {
              diagnostics.add(place.at(*find_entry(*place.value->mapping(), "anchor")),
                              "only a spring with a 'stiffness' pulls to an anchor");
            }
          }));
}

/// Describes a contradiction between the keys of one support; "" if there is none.
std::string contradiction(const SupportText& support) {
  const bool moves = support.motion.x || support.motion.y || support.motion.angle;
  if (support.clamp && !support.fix.empty()) {
    return "'clamp: true' holds every component already: remove 'fix'";
  }
  if (support.clamp && support.spring) {
    return "'clamp: true' holds all that a spring could: remove one of them";
  }
  if (!support.clamp && support.motion.angle) {
    return "'angle' turns a clamp: add 'clamp: true', or remove it";
  }
  if (!support.clamp && support.fix.empty() && !moves && !support.spring) {
    return "this support holds nothing: give 'fix', 'clamp: true', 'prescribe' or 'spring'";
  }
  for (std::size_t i = 0; i < support.fix.size(); ++i) {
    const Component component = support.fix[i];
    const char* name = component == Component::X ? "x" : "y";
    if (std::find(support.fix.begin(), support.fix.begin() + static_cast<std::ptrdiff_t>(i),
                  component) != support.fix.begin() + static_cast<std::ptrdiff_t>(i)) {
      return fmt::format("'{}' is fixed twice", name);
    }
    if (component == Component::X ? support.motion.x.has_value() : support.motion.y.has_value()) {
      return fmt::format("'{}' is both fixed and prescribed: give one or the other", name);
    }
  }
  return {};
}

void check_support(SupportText& support, const Place& place, Diagnostics& diagnostics) {
  const std::string problem = contradiction(support);
  if (!problem.empty()) diagnostics.add(place, problem);
}

Support completed(SupportText text) {
  if (text.motion.x) text.prescribe.push_back({Component::X, std::move(*text.motion.x)});
  if (text.motion.y) text.prescribe.push_back({Component::Y, std::move(*text.motion.y)});
  text.rotation = std::move(text.motion.angle);
  return static_cast<Support&&>(text);
}

}  // namespace

Format<Support> support_format() {
  Format<SupportText> as_written = mapping(
      Table<SupportText>("support", "Holds or moves nodes of a rod, or holds a place by springs.")
          .required("rod", &Support::rod, name(), "Name of the rod.")
          .required("at", &Support::at, location(),
                    "The node, or all; there has to be a node. For a spring alone: any arc length.")
          .optional("fix", &Support::fix, list_of(component_format(), 1),
                    "Components that stay at their initial value.")
          .optional("clamp", &Support::clamp, boolean(),
                    "Whether the node and the direction of the rod at it are held.")
          .optional("prescribe", &SupportText::motion, prescribe_format(),
                    "Components that move over time.")
          .optional("spring", &Support::spring, spring_format(),
                    "Springs that hold the place. Several at one place add up.")
          .check(check_support));
  Shape shape = as_written.shape;
  return {std::move(shape),
          [as_written = std::move(as_written)](const Shape& /*self*/, const Place& place,
                                               Diagnostics& diagnostics, Support& out) {
            SupportText text;
            const bool fine = as_written.read(place, diagnostics, text);
            out = completed(std::move(text));
            return fine;
          }};
}

}  // namespace der::scenario
