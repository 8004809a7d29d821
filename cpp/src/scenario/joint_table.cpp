#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

Format<JointMember> member_format() {
  return mapping(Table<JointMember>("member of a joint", "A rod at one of its places.")
                     .required("rod", &JointMember::rod, name(), "Name of the rod.")
                     .required("at", &JointMember::at, location(), "The place, an end or inside."));
}

Format<HingeSpring> spring_format() {
  return mapping(Table<HingeSpring>("spring of a hinge",
                                    "Holds two rods at the angle at which they are drawn.")
                     .required("rotational_stiffness", &HingeSpring::rotational_stiffness,
                               number("N m/rad", positive()), "Moment per angle."));
}

Format<HingeMotion> motion_format() {
  return mapping(Table<HingeMotion>("motion of a hinge", "Drives a hinge, as a servo does.")
                     .required("angle", &HingeMotion::angle, series("rad"),
                               "Angle by which the second rod turns against the first one, "
                               "counter-clockwise, from that at which they are drawn."));
}

}  // namespace

Format<Joint> joint_format() {
  return mapping(
      Table<Joint>("joint", "Joins rods that meet at a point, or names a point of one rod.")
          .required("name", &Joint::name, name(), "Name of the joint.")
          .required("of", &Joint::of, list_of(member_format(), 1),
                    "The rods that meet, each at its place; one alone has a joint there.")
          .optional(
              "kind", &Joint::kind,
              choice<JointKind>({{{"rigid", "the rods keep the angles between them, as if welded"},
                                  JointKind::Rigid},
                                 {{"hinge", "each rod turns freely about the others, in a plane"},
                                  JointKind::Hinge},
                                 {{"ball", "each rod turns freely about the others, in space"},
                                  JointKind::Ball}}),
              "How they are joined.")
          .optional("spring", &Joint::spring, spring_format(),
                    "Only with `kind: hinge`, between two rods: a spring that turns with them.")
          .optional("damping", &Joint::damping, number("N m s/rad", not_negative()),
                    "Likewise: moment per rate of the angle between the two.", "0")
          .optional("prescribe", &Joint::prescribe, motion_format(),
                    "Only with `kind: hinge`, between two rods: its angle over time."));
}

}  // namespace der::scenario
