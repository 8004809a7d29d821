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
  std::optional<Series> z;
  std::optional<Series> angle;
  std::optional<AxisRotation> rotation;
  std::optional<Series> twist;

  [[nodiscard]] const std::optional<Series>& displacement(Component component) const {
    return component == Component::X ? x : component == Component::Y ? y : z;
  }
  [[nodiscard]] bool moves() const { return x || y || z || angle || rotation || twist; }
};

struct SupportText : Support {
  PrescribeText motion;
};

Format<Component> component_format() {
  return choice<Component>(
      {{{"x", ""}, Component::X}, {{"y", ""}, Component::Y}, {{"z", ""}, Component::Z}},
      {{"angle", "to hold the direction of the rod write 'clamp: true'"},
       {"twist", "to hold the section of the rod write 'clamp: true'"}});
}

/// `true`, `false` or `tangent`.
Format<Clamp> clamp_format() {
  const Format<bool> truth = boolean();
  const Format<Clamp> word = choice<Clamp>(
      {{{"tangent",
         "the node and the direction of the rod are held, and the rod is free to spin "
         "about it (as with `true` in a planar scene)"},
        Clamp::Tangent}});
  Shape shape{Shape::Kind::AnyOf};
  shape.parts = {truth.shape, word.shape};
  return {std::move(shape),
          [truth](const Shape& self, const Place& place, Diagnostics& diagnostics, Clamp& out) {
            const std::string* written = text_of(*place.value);
            if (written && *written == "tangent") {
              out = Clamp::Tangent;
              return true;
            }
            bool held = false;
            if (!truth.read_shape(self, place, diagnostics, held)) return false;
            out = held ? Clamp::Section : Clamp::None;
            return true;
          }};
}

Format<AxisRotation> rotation_format() {
  return mapping(
      Table<AxisRotation>("rotation", "Turns a clamp about an axis through its node.")
          .required("axis", &AxisRotation::axis, space_vector(""), "Direction, of any length.")
          .required("angle", &AxisRotation::angle, series("rad"), "Angle, right-handed.")
          .check([](AxisRotation& rotation, const Place& place, Diagnostics& diagnostics) {
            if (!is_zero(rotation.axis)) return;
            diagnostics.add(place.at(*find_entry(*place.value->mapping(), "axis")),
                            "an axis needs a direction: its components are all 0");
          }));
}

Format<PrescribeText> prescribe_format() {
  return mapping(
      Table<PrescribeText>("prescribed motion",
                           "Displacements from the initial position and the "
                           "rotation of a clamp, over time.")
          .optional("x", &PrescribeText::x, series("m"), "Displacement along x.")
          .optional("y", &PrescribeText::y, series("m"), "Displacement along y.")
          .optional("z", &PrescribeText::z, series("m"), "Displacement along z.")
          .optional("angle", &PrescribeText::angle, series("rad"),
                    "Rotation of the clamped tangent, positive counter-clockwise; only with a "
                    "clamp, in a scene of two components.")
          .optional("rotation", &PrescribeText::rotation, rotation_format(),
                    "Rotation of a clamp about an axis.")
          .optional("twist", &PrescribeText::twist, series("rad"),
                    "Rotation of the clamped section about the held tangent, right-handed about "
                    "the direction of growing arc length; only with `clamp: true`.")
          .at_most_one({{"angle"}, {"rotation"}}));
}

Format<Spring> spring_format() {
  return mapping(
      Table<Spring>("spring", "An elastic support.")
          .optional("stiffness", &Spring::stiffness, axis_stiffness("N/m"),
                    "Force per displacement from the anchor: one number, or one along each axis, "
                    "of which some may be 0.",
                    "none")
          .optional("anchor", &Spring::anchor, vector("m"),
                    "Where the place is without a force of the spring.",
                    "where the place is as drawn")
          .optional("rotational_stiffness", &Spring::rotational_stiffness,
                    section_stiffness("N m/rad"),
                    "Moment per angle between the rod's section and its drawn orientation: one "
                    "number, or a list of three, against turning towards the director, across it, "
                    "and about the rod.",
                    "none")
          .check([](Spring& spring, const Place& place, Diagnostics& diagnostics) {
            if (spring.stiffness.empty() && spring.rotational_stiffness.empty()) {
              diagnostics.add(place, "give 'stiffness', 'rotational_stiffness' or both");
            } else if (spring.stiffness.empty() && !spring.anchor.empty()) {
              diagnostics.add(place.at(*find_entry(*place.value->mapping(), "anchor")),
                              "only a spring with a 'stiffness' pulls to an anchor");
            }
          }));
}

/// Says which component is named twice, or prescribed as well; "" if none is.
std::string contradiction(const std::vector<Component>& components, const char* as,
                          const PrescribeText& motion) {
  for (auto it = components.begin(); it != components.end(); ++it) {
    if (std::find(components.begin(), it, *it) != it) {
      return fmt::format("'{}' is {} twice", name_of(*it), as);
    }
    if (motion.displacement(*it)) {
      return fmt::format("'{}' is both {} and prescribed: give one or the other", name_of(*it), as);
    }
  }
  return {};
}

/// Describes a contradiction between the keys of one support; "" if there is none.
std::string contradiction(const SupportText& support) {
  const PrescribeText& motion = support.motion;
  const char* held = support.clamp == Clamp::Tangent ? "tangent" : "true";
  if (support.clamps() && !support.fix.empty()) {
    return fmt::format("'clamp: {}' holds every component{}: remove 'fix'", held,
                       support.free.empty() ? " already" : " that is not in 'free'");
  }
  if (support.clamps() && support.free.empty() && support.spring) {
    return fmt::format("'clamp: {}' holds all that a spring could: remove one of them", held);
  }
  if (support.clamp == Clamp::Tangent && motion.twist) {
    return "'twist' turns a section that is held, and 'clamp: tangent' leaves it free: write "
           "'clamp: true', or remove it";
  }
  if (!support.free.empty() && !support.clamps()) {
    return "'free' is of a clamp: add 'clamp: true', or remove it";
  }
  if (!support.clamps()) {
    if (motion.angle) return "'angle' turns a clamp: add 'clamp: true', or remove it";
    if (motion.rotation) return "'rotation' turns a clamp: add 'clamp: true', or remove it";
    if (motion.twist) return "'twist' turns a clamp: add 'clamp: true', or remove it";
  }
  if (!support.holds() && !motion.moves() && !support.spring) {
    return "this support holds nothing: give 'fix', 'clamp: true', 'prescribe' or 'spring'";
  }
  const std::string fixed = contradiction(support.fix, "fixed", motion);
  return fixed.empty() ? contradiction(support.free, "free", motion) : fixed;
}

void check_support(SupportText& support, const Place& place, Diagnostics& diagnostics) {
  const std::string problem = contradiction(support);
  if (!problem.empty()) diagnostics.add(place, problem);
}

Support completed(SupportText text) {
  for (const Component component : {Component::X, Component::Y, Component::Z}) {
    const std::optional<Series>& displacement = text.motion.displacement(component);
    if (displacement) text.prescribe.push_back({component, *displacement});
  }
  text.rotation = std::move(text.motion.angle);
  text.axis_rotation = std::move(text.motion.rotation);
  text.twist = std::move(text.motion.twist);
  return static_cast<Support&&>(text);
}

}  // namespace

Format<Support> support_format() {
  Format<SupportText> as_written = mapping(
      Table<SupportText>("support", "Holds or moves nodes of a rod, or holds a place by springs.")
          .optional("name", &Support::name, name(),
                    "A name, by which a program sets what the support prescribes.", "none")
          .optional("rod", &Support::rod, name(), "Name of the rod.")
          .optional("at", &Support::at, location(),
                    "The node, or all; there has to be a node. For a spring alone: any arc length.")
          .optional("joint", &Support::joint, name(), "In place of `rod` and `at`: a joint.")
          .either({{"rod", "at"}, {"joint"}})
          .optional("fix", &Support::fix, list_of(component_format(), 1),
                    "Components that stay at their initial value.")
          .optional("clamp", &Support::clamp, clamp_format(),
                    "Whether the node, the direction of the rod at it and its section are held: "
                    "all that a wall holds.",
                    "false")
          .optional("free", &Support::free, list_of(component_format(), 1),
                    "Only with a clamp: components along which its node may move. The direction "
                    "and the section stay held.",
                    "none")
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
