#include "der/scenario/load.hpp"
#include "scenario/axis_stiffness.hpp"
#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

constexpr auto assign_load = [](Load& load, auto&& what) {
  load.what = std::forward<decltype(what)>(what);
};

Format<Fluid> fluid_format() {
  return mapping(
      Table<Fluid>("fluid",
                   "A viscous fluid at rest, felt by the spheres: Stokes drag 6 pi mu R u "
                   "and buoyancy.")
          .required("density", &Fluid::density, number("kg/m^3", not_negative()),
                    "Density; 0: no buoyancy.")
          .required("viscosity", &Fluid::viscosity, number("Pa s", not_negative()),
                    "Dynamic viscosity mu."));
}

Format<Damping> damping_format() {
  return mapping(
      Table<Damping>("damping",
                     "A force -coefficient * velocity per rest length. Several of them "
                     "add up.")
          .required("coefficient", &Damping::coefficient, number("N s/m^2", not_negative()),
                    "Force per velocity and length.")
          .optional("rod", &Damping::rod, name(), "Name of the rod that it acts on.", "every rod"));
}

Format<PointForce> point_force_format() {
  return mapping(
      Table<PointForce>("point force", "A force that keeps its direction, or turns with the rod.")
          .optional("rod", &PointForce::rod, name(), "Name of the rod.")
          .optional("at", &PointForce::at, location(),
                    "Where; any arc length. With `all` it acts on each node. A support "
                    "takes up the components that it holds there, with a warning.")
          .optional("joint", &PointForce::joint, name(), "In place of `rod` and `at`: a joint.")
          .either({{"rod", "at"}, {"joint"}})
          .required("force", &PointForce::force, vector_series("N"),
                    "A constant, or a table over time.")
          .optional("follower", &PointForce::follower, boolean(),
                    "Whether it turns with the rod: in space with the section, in a "
                    "planar scene with the tangent. `force` has its components in the "
                    "initial shape.",
                    "false"));
}

struct MomentValue {
  Series about_z;
  VectorSeries vector;
};

struct MomentText : Moment {
  MomentValue value;
};

constexpr auto assign_moment = [](Load& load, MomentText&& text) {
  text.moment = std::move(text.value.about_z);
  text.moment_vector = std::move(text.value.vector);
  load.what = static_cast<Moment&&>(text);
};

/// Whether a value is written as a vector, or as a table of such.
bool is_vector(const Value& value) {
  if (value.sequence()) return true;
  const Mapping* table = value.mapping();
  if (!table) return false;
  if (const Entry* sine = find_entry(*table, "sine"); sine && sine->value.mapping()) {
    const Entry* amplitude = find_entry(*sine->value.mapping(), "amplitude");
    return amplitude && amplitude->value.sequence();
  }
  const Entry* values = find_entry(*table, "values");
  const Sequence* items = values ? values->value.sequence() : nullptr;
  return items && !items->empty() && items->front().sequence();
}

/// A moment about z, or a vector, each constant or over time.
Format<MomentValue> moment_value_format() {
  const Format<Series> about_z = series("N m");
  const Format<VectorSeries> vector = space_vector_series("N m");
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = about_z.shape.unit;
  for (const Shape* form : {&about_z.shape, &vector.shape}) {
    shape.parts.insert(shape.parts.end(), form->parts.begin(), form->parts.end());
  }
  return {std::move(shape), [about_z, vector](const Shape& /*self*/, const Place& place,
                                              Diagnostics& diagnostics, MomentValue& out) {
            const Sequence* items = place.value->sequence();
            if (items && items->size() != 3) {
              report_expected(fmt::format("{} or {}", expected(about_z.shape.parts[0]),
                                          expected(vector.shape.parts[0])),
                              place, diagnostics);
              return false;
            }
            if (is_vector(*place.value)) return vector.read(place, diagnostics, out.vector);
            return about_z.read(place, diagnostics, out.about_z);
          }};
}

Format<MomentText> moment_format() {
  return mapping(
      Table<MomentText>("moment", "A moment at a place of a rod.")
          .optional("rod", &Moment::rod, name(), "Name of the rod.")
          .optional("at", &Moment::at,
                    single_location("'all' is not a single place, and a moment acts at one"),
                    "Where; any arc length.")
          .optional("joint", &Moment::joint, name(),
                    "In place of `rod` and `at`: a rigid joint; or a hinge of two rods, between "
                    "which the "
                    "moment acts: as it is on the second, the opposite on the first.")
          .either({{"rod", "at"}, {"joint"}})
          .required("moment", &MomentText::value, moment_value_format(),
                    "A number: about z, positive counter-clockwise. A vector in a scene of three "
                    "components. Constant, or a table over time.")
          .optional("follower", &Moment::follower, boolean(),
                    "Whether it turns with the section; `moment` has its components in the initial "
                    "shape. No difference in a planar scene.",
                    "false"));
}

/// Where the part of a rod lies on which a load acts: the last keys of its table.
template <class OnPartOfRod>
Table<OnPartOfRod> with_part(Table<OnPartOfRod> table) {
  return std::move(table
                       .optional("from", &OnPartOfRod::from, number("m", not_negative()),
                                 "Arc length where the part starts.")
                       .optional("to", &OnPartOfRod::to, number("m", positive()),
                                 "Arc length where the part ends.", "the rod's length")
                       .check([](OnPartOfRod& load, const Place& place, Diagnostics& diagnostics) {
                         if (load.from < load.to) return;
                         diagnostics.add(place.at(*find_entry(*place.value->mapping(), "to")),
                                         fmt::format("must be greater than 'from' ({} m), got {} m",
                                                     load.from, load.to));
                       }));
}

Format<DistributedForce> distributed_force_format() {
  return mapping(with_part(Table<DistributedForce>("distributed force",
                                                   "A force per rest length that keeps its "
                                                   "direction, on a part of a rod.")
                               .required("rod", &DistributedForce::rod, name(), "Name of the rod.")
                               .required("force", &DistributedForce::force, vector_series("N/m"),
                                         "A constant, or a table over time.")));
}

Format<Foundation> foundation_format() {
  return mapping(with_part(
      Table<Foundation>("foundation",
                        "Springs along a part of a rod that pull every point to where it is drawn.")
          .required("rod", &Foundation::rod, name(), "Name of the rod.")
          .required("stiffness", &Foundation::stiffness, axis_stiffness("N/m^2"),
                    "Force per rest length and displacement: of all axes, or one along each; at "
                    "least one greater than 0.")));
}

}  // namespace

Format<Load> load_format() {
  return mapping(
      Table<Load>("load", "Exactly one of these keys, and a name if it is to have one.")
          .optional("name", &Load::name, name(), "A name, by which a program sets the load.",
                    "none")
          .kind(
              Gravity::kKey, vector_series("m/s^2"),
              [](Load& load, VectorSeries&& g) { load.what = Gravity{std::move(g)}; },
              "Acceleration of gravity: a constant, or a table over time.")
          .kind(Fluid::kKey, fluid_format(), assign_load, "A viscous fluid around the spheres.")
          .kind(Damping::kKey, damping_format(), assign_load, "Linear damping along rods.")
          .kind(PointForce::kKey, point_force_format(), assign_load, "A force at a place.")
          .kind(Moment::kKey, moment_format(), assign_moment, "A moment at a place.")
          .kind(DistributedForce::kKey, distributed_force_format(), assign_load,
                "A force per length on a part of a rod.")
          .kind(Foundation::kKey, foundation_format(), assign_load,
                "An elastic foundation of a part of a rod. It holds the rod as supports do: a path "
                "of loads leaves it as it is."));
}

}  // namespace der::scenario
