#include "der/catalog/quantities.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "der/model/model.hpp"
#include "der/output/actuation_forces.hpp"
#include "der/output/reactions.hpp"
#include "output/bend_field.hpp"
#include "output/motion_field.hpp"
#include "output/ring_numbers.hpp"
#include "output/section_field.hpp"
#include "output/smaller_model.hpp"
#include "output/stretch_field.hpp"
#include "output/tangent_field.hpp"

namespace der {
namespace {

template <Vector State::* vector, int number>
Quantity component(std::string name, std::string unit, QuantityKind kind, std::string meaning) {
  const RodFieldMaker maker = [](const RodMesh& rod, const Model& model) {
    return make_component_field(vector, number, rod, model);
  };
  Quantity quantity{std::move(name), std::move(unit), kind, std::move(meaning), maker, {}, true};
  if (number == 2) {
    quantity.scope = QuantityScope::Space;
    quantity.make_field_in_smaller = [](const RodMesh& rod, const Model& model) {
      return scaled(0.0, make_component_field(vector, 0, rod, model));
    };
  }
  return quantity;
}

Quantity field(std::string name, std::string unit, QuantityKind kind, std::string meaning,
               RodFieldMaker maker) {
  return {std::move(name), std::move(unit), kind, std::move(meaning), maker, {}, false};
}

/// A quantity that has a sign in a plane. The scene decides, not the model that is chosen for it.
template <RodFieldMaker make>
Quantity bending(std::string name, std::string unit, std::string meaning) {
  const RodFieldMaker maker = [](const RodMesh& rod, const Model& model) {
    const bool is_flat_scene_in_space = model.dimension == 2 && model.stands_for_space;
    return is_flat_scene_in_space ? magnitude(make(rod, model), rod) : make(rod, model);
  };
  return field(std::move(name), std::move(unit), QuantityKind::Bend, std::move(meaning), maker);
}

/// `advice` tells what to take in other models.
Quantity in(QuantityScope scope, Quantity quantity, std::string advice = {}) {
  quantity.scope = scope;
  quantity.advice = std::move(advice);
  return quantity;
}

template <int number>
Quantity tangent(std::string name, std::string meaning) {
  const RodFieldMaker maker = [](const RodMesh& rod, const Model& model) {
    return make_tangent_field(number, rod, model);
  };
  Quantity quantity = field(std::move(name), "", QuantityKind::Tangent, std::move(meaning), maker);
  if (number == 2) {
    quantity.scope = QuantityScope::Space;
    quantity.make_field_in_smaller = [](const RodMesh& rod, const Model& model) {
      return scaled(0.0, make_tangent_field(0, rod, model));
    };
  }
  return quantity;
}

template <SectionQuantity quantity>
Quantity section(std::string name, std::string unit, std::string meaning,
                 QuantityKind kind = QuantityKind::Section) {
  const RodFieldMaker maker = [](const RodMesh& rod, const Model& model) {
    return make_section_field(quantity, rod, model);
  };
  Quantity row = in(QuantityScope::Sections,
                    field(std::move(name), std::move(unit), kind, std::move(meaning), maker));
  row.make_field_in_smaller = [](const RodMesh& rod, const Model& model) {
    return make_section_field_in_smaller(quantity, rod, model);
  };
  row.is_towards_director = is_towards_director(quantity);
  return row;
}

Quantity energy(std::string name, std::string meaning, std::vector<EnergyTerm> terms) {
  return {std::move(name),  kEnergyUnit, QuantityKind::Energy, std::move(meaning), nullptr,
          std::move(terms), false};
}

std::vector<Quantity> quantities_along_rods() {
  using Kind = QuantityKind;
  return {
      component<&State::positions, 0>("x", "m", Kind::Position, "horizontal position"),
      component<&State::positions, 1>("y", "m", Kind::Position, "vertical position"),
      component<&State::positions, 2>("z", "m", Kind::Position, "position along z, in space"),
      component<&State::velocities, 0>("vx", "m/s", Kind::Velocity, "horizontal velocity"),
      component<&State::velocities, 1>("vy", "m/s", Kind::Velocity, "vertical velocity"),
      component<&State::velocities, 2>("vz", "m/s", Kind::Velocity, "velocity along z, in space"),
      field("speed", "m/s", Kind::Velocity, "magnitude of the velocity", make_speed_field),
      in(QuantityScope::Planar,
         field("turning_angle", "rad", Kind::Turn,
               "angle from the edge before a node to the edge after it, positive counter-clockwise",
               make_turning_angle_field),
         "it has a sign in a plane only, take 'curvature'"),
      in(QuantityScope::Planar,
         field(std::string(kSlope), "rad", Kind::Tangent,
               "angle of the tangent from the x axis, counter-clockwise, whole turns included",
               make_slope_field),
         "an angle from an axis tells no direction in space, take 'tx', 'ty' and 'tz'"),
      tangent<0>("tx", "x component of the unit tangent, toward the end of the rod"),
      tangent<1>("ty", "y component of the unit tangent"),
      tangent<2>("tz", "z component of the unit tangent, in space"),
      bending<make_curvature_field>("curvature", "1/m",
                                    "turning angle per length, positive counter-clockwise; in a "
                                    "scene of three components its magnitude"),
      bending<make_moment_field>("moment", "N m",
                                 "bending moment, positive where it bends counter-clockwise; in a "
                                 "scene of three components its magnitude"),
      section<SectionQuantity::Curvature1>("curvature_1", "1/m",
                                           "curvature towards the first director"),
      section<SectionQuantity::Curvature2>("curvature_2", "1/m",
                                           "curvature towards the second director"),
      section<SectionQuantity::Moment1>(
          "moment_1", "N m", "bending moment of the curvature towards the first director"),
      section<SectionQuantity::Moment2>(
          "moment_2", "N m", "bending moment of the curvature towards the second director"),
      section<SectionQuantity::Twist>("twist", "rad/m", "rotation of the section per length"),
      section<SectionQuantity::Torque>("torque", "N m", "moment about the tangent"),
      in(QuantityScope::Planar,
         field("natural_curvature", "1/m", Kind::Natural,
               "curvature without stress, with what actuations add to it, positive "
               "counter-clockwise",
               make_natural_curvature_field),
         "in space take 'natural_curvature_1' and 'natural_curvature_2'"),
      section<SectionQuantity::NaturalCurvature1>(
          "natural_curvature_1", "1/m",
          "curvature without stress towards the first director, with what actuations add to it",
          Kind::Natural),
      section<SectionQuantity::NaturalCurvature2>(
          "natural_curvature_2", "1/m",
          "curvature without stress towards the second director, with what actuations add to it",
          Kind::Natural),
      section<SectionQuantity::NaturalTwist>("natural_twist", "rad/m",
                                             "twist without stress, with what actuations add to it",
                                             Kind::Natural),
      field("strain", "", Kind::Edge, "elongation per rest length", make_strain_field),
      field("tension", "N", Kind::Edge, "axial force, positive in tension", make_tension_field),
  };
}

Quantity ring_number(std::string name, std::string meaning, RodReading read) {
  Quantity quantity{std::move(name), "", QuantityKind::Ring, std::move(meaning), nullptr, {}};
  quantity.read_rod = read;
  return quantity;
}

std::vector<Quantity> quantities_of_rings() {
  return {
      in(QuantityScope::Space,
         ring_number("writhe", "how much a ring coils about itself, in whole coils", writhe_of)),
      in(QuantityScope::Sections,
         ring_number("link", "turns of the sections of a ring around it: twist and writhe",
                     link_of)),
  };
}

/// A component of what a support exerts on the rod.
template <Vec3 Reaction::* vector, Index number>
Quantity reaction(std::string name, std::string unit, std::string meaning) {
  Quantity quantity{std::move(name),    std::move(unit), QuantityKind::Support,
                    std::move(meaning), nullptr,         {}};
  quantity.read_reaction = [](const Reaction& sum) { return (sum.*vector)[number]; };
  return quantity;
}

template <Index number>
Quantity moment_in_space(const std::string& axis) {
  return in(QuantityScope::Space,
            reaction<&Reaction::moment, number>(
                "reaction_moment_" + axis, "N m",
                axis + " component of the moment that a support exerts on the rod, in space"),
            "in a plane take 'reaction_moment'");
}

std::vector<Quantity> quantities_of_supports() {
  constexpr auto force = &Reaction::force;
  constexpr auto moment = &Reaction::moment;
  return {
      reaction<force, 0>("reaction_x", "N",
                         "x component of the force that a support exerts on the rod"),
      reaction<force, 1>("reaction_y", "N", "y component of that force"),
      in(QuantityScope::Space,
         reaction<force, 2>("reaction_z", "N", "z component of that force, in space")),
      in(QuantityScope::Planar,
         reaction<moment, 2>("reaction_moment", "N m",
                             "moment that a support exerts on the rod, counter-clockwise"),
         "a moment in space is a vector, take 'reaction_moment_x', 'reaction_moment_y' and "
         "'reaction_moment_z'"),
      moment_in_space<0>("x"),
      moment_in_space<1>("y"),
      moment_in_space<2>("z"),
  };
}

/// Readers of the forces that an actuation exerts on the rod.
template <std::size_t number = 0>
Quantity actuation(scenario::Actuated what, std::string name, std::string unit,
                   std::string meaning) {
  Quantity quantity{std::move(name),    std::move(unit), QuantityKind::Actuation,
                    std::move(meaning), nullptr,         {}};
  quantity.read_actuation = [](const ActuationForce& force) { return force.values[number]; };
  quantity.actuates = scenario::key_of(what);
  return quantity;
}

std::vector<Quantity> quantities_of_actuations() {
  using scenario::Actuated;
  return {
      in(QuantityScope::Planar,
         actuation(Actuated::Curvature, "actuation_moment", "N m",
                   "moment with which an actuation bends its stretch, counter-clockwise"),
         "in space take 'actuation_moment_1' and 'actuation_moment_2'"),
      in(QuantityScope::Sections,
         actuation<0>(Actuated::Curvature, "actuation_moment_1", "N m",
                      "moment with which an actuation bends its stretch towards the first "
                      "director"),
         "in a plane take 'actuation_moment'"),
      in(QuantityScope::Sections,
         actuation<1>(Actuated::Curvature, "actuation_moment_2", "N m",
                      "the same towards the second director"),
         "in a plane take 'actuation_moment'"),
      in(QuantityScope::Sections, actuation(Actuated::Twist, "actuation_torque", "N m",
                                            "torque with which an actuation twists its stretch")),
      actuation(Actuated::Length, "actuation_force", "N",
                "force with which an actuation elongates its stretch"),
  };
}

Quantity of_joint(JointQuantity what, std::string name, std::string unit, std::string meaning) {
  Quantity quantity{std::move(name),    std::move(unit), QuantityKind::Joint,
                    std::move(meaning), nullptr,         {}};
  quantity.of_joint = what;
  return quantity;
}

Quantity rotation_in_space(JointQuantity what, const std::string& axis) {
  return in(QuantityScope::Sections,
            of_joint(what, "rotation_" + axis, "rad",
                     axis + " component of the rotation vector of a rigid joint from the initial "
                            "shape, of up to half a turn, in space"),
            "in a plane take 'rotation'");
}

std::vector<Quantity> quantities_of_joints() {
  return {
      in(QuantityScope::Planar,
         of_joint(JointQuantity::Rotation, "rotation", "rad",
                  "rotation of a rigid joint from the initial shape, counter-clockwise, whole "
                  "turns included"),
         "a rotation in space is a vector, take 'rotation_x', 'rotation_y' and 'rotation_z'"),
      rotation_in_space(JointQuantity::RotationX, "x"),
      rotation_in_space(JointQuantity::RotationY, "y"),
      rotation_in_space(JointQuantity::RotationZ, "z"),
      in(QuantityScope::Planar,
         of_joint(JointQuantity::Angle, "angle", "rad",
                  "by how much the second rod of a hinge of two has turned against the first from "
                  "the initial shape, counter-clockwise, whole turns included"),
         "a hinge is of scenes of two components"),
      of_joint(JointQuantity::ForceX, "force_x", "N",
               "x component of the force that a rod exerts on a joint"),
      of_joint(JointQuantity::ForceY, "force_y", "N", "y component of that force"),
      in(QuantityScope::Sections,
         of_joint(JointQuantity::ForceZ, "force_z", "N", "z component of that force, in space")),
      in(QuantityScope::Sections,
         of_joint(JointQuantity::MomentX, "moment_x", "N m",
                  "x component of the moment that a rod exerts on a joint, in space")),
      in(QuantityScope::Sections, of_joint(JointQuantity::MomentY, "moment_y", "N m",
                                           "y component of that moment, in space")),
      of_joint(JointQuantity::MomentZ, "moment_z", "N m",
               "z component of that moment; in a plane the moment, counter-clockwise"),
  };
}

Quantity of_spring(SpringReading read, std::string name, std::string unit, std::string meaning) {
  Quantity quantity{std::move(name),    std::move(unit), QuantityKind::Spring,
                    std::move(meaning), nullptr,         {}};
  quantity.read_spring = read;
  return quantity;
}

std::vector<Quantity> quantities_of_springs() {
  return {
      of_spring([](double length, double /*tension*/) { return length; }, "spring_length", "m",
                "length of a spring between joints"),
      of_spring([](double /*length*/, double tension) { return tension; }, "spring_force", "N",
                "force with which a spring between joints pulls them towards one another, that of "
                "its damper included"),
  };
}

/// Each term by itself, what is stored elastically, and all together.
std::vector<Quantity> energy_quantities() {
  std::vector<Quantity> rows;
  std::vector<EnergyTerm> elastic;
  std::vector<EnergyTerm> all;
  for (const EnergyTermInfo& row : kEnergyTerms) {
    rows.push_back(energy(std::string(row.name) + "_energy", row.meaning, {row.term}));
    if (row.elastic) elastic.push_back(row.term);
    all.push_back(row.term);
  }
  rows.push_back(
      energy("elastic_energy", "energy stored in rods, springs and foundations", elastic));
  rows.push_back(energy("total_energy", "kinetic, elastic and gravity energy together", all));
  return rows;
}

std::vector<Quantity> all_quantities() {
  std::vector<Quantity> rows = quantities_along_rods();
  for (Quantity& row : quantities_of_rings()) rows.push_back(std::move(row));
  for (Quantity& row : quantities_of_supports()) rows.push_back(std::move(row));
  for (Quantity& row : quantities_of_actuations()) rows.push_back(std::move(row));
  for (Quantity& row : quantities_of_joints()) rows.push_back(std::move(row));
  for (Quantity& row : quantities_of_springs()) rows.push_back(std::move(row));
  for (Quantity& row : energy_quantities()) rows.push_back(std::move(row));
  return rows;
}

/// The advice to whoever asks for a quantity that the model lacks.
const char* advice_on(QuantityScope scope) {
  switch (scope) {
    case QuantityScope::All:
      break;
    case QuantityScope::Planar:
      return "it is one of planar rods";
    case QuantityScope::Space:
      return "write 'model: spatial', or 'spatial_bend' for a rod that cannot twist";
    case QuantityScope::Sections:
      return "write 'model: spatial', in which sections count";
  }
  return "";
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> table = all_quantities();
  return table;
}

bool is_own(const Quantity& quantity, const Model& model) {
  return is_available_in(model.dimension, model.has_sections(), quantity);
}

bool is_available(const Quantity& quantity, const Model& model) {
  if (model.dimension == 2 && model.stands_for_space) return !is_of_plane(quantity);
  return is_own(quantity, model);
}

bool is_answered(const Quantity& quantity, const Model& model) {
  return is_available(quantity, model) || (model.stands_for_space && is_of_space(quantity));
}

bool is_of_plane(const Quantity& quantity) { return quantity.scope == QuantityScope::Planar; }
bool is_of_space(const Quantity& quantity) { return quantity.scope > QuantityScope::Planar; }

bool is_available_in(int dimension, bool has_sections, const Quantity& quantity) {
  switch (quantity.scope) {
    case QuantityScope::All:
      return true;
    case QuantityScope::Planar:
      return dimension == 2;
    case QuantityScope::Space:
      return dimension == 3;
    case QuantityScope::Sections:
      break;
  }
  return has_sections;
}

std::string lacks(std::string_view model, const Quantity& quantity) {
  const std::string advice = quantity.advice.empty() ? advice_on(quantity.scope) : quantity.advice;
  return fmt::format("the model '{}' has no '{}': {}", model, quantity.name, advice);
}

std::string lacks_in_flat_scene(const Quantity& quantity) {
  return fmt::format(
      "a scene of three components has no '{}', flat as it is: {}; or write 'model: "
      "planar'",
      quantity.name, quantity.advice);
}

std::string lacks_held_section(std::string_view rod, std::string_view quantity) {
  return fmt::format(
      "no clamp holds the section of rod '{}', which may spin: the model 'spatial_bend' has no "
      "'{}' of it. Write 'model: spatial'",
      rod, quantity);
}

const Quantity* find_quantity(std::string_view name) {
  const auto& table = quantities();
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Quantity& quantity) { return quantity.name == name; });
  return found == table.end() ? nullptr : &*found;
}

}  // namespace der
