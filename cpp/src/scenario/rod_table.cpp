#include "scenario/scene_text.hpp"
#include "scenario/table.hpp"

namespace der::scenario {
namespace {

constexpr auto assign_kind = [](SectionText& section, auto&& kind) {
  section.shape = std::forward<decltype(kind)>(kind);
};

Format<Circle> circle_format() {
  return mapping(Table<Circle>("circle", "A solid round rod.")
                     .required("radius", &Circle::radius, number("m", positive()), "Radius."));
}

Format<Tube> tube_format() {
  return mapping(
      Table<Tube>("tube", "A hollow round rod.")
          .required("inner_radius", &Tube::inner_radius, number("m", not_negative()),
                    "Radius of the hole.")
          .required("outer_radius", &Tube::outer_radius, number("m", positive()), "Outer radius.")
          .check([](Tube& tube, const Place& place, Diagnostics& diagnostics) {
            if (tube.inner_radius < tube.outer_radius) return;
            diagnostics.add(place.at(*find_entry(*place.value->mapping(), "inner_radius")),
                            fmt::format("must be smaller than 'outer_radius', but {} m is not "
                                        "smaller than {} m",
                                        tube.inner_radius, tube.outer_radius));
          }));
}

constexpr const char* kWidth =
    "Size along the director: without one, out of the plane of a planar scene.";
constexpr const char* kHeight =
    "Size across the director: without one, in the plane of bending of a planar scene.";

Format<Rectangle> rectangle_format() {
  return mapping(Table<Rectangle>("rectangle", "A solid rod with a rectangular cross-section.")
                     .required("width", &Rectangle::width, number("m", positive()), kWidth)
                     .required("height", &Rectangle::height, number("m", positive()), kHeight));
}

Format<Ellipse> ellipse_format() {
  return mapping(Table<Ellipse>("ellipse", "A solid rod with an elliptic cross-section.")
                     .required("width", &Ellipse::width, number("m", positive()), kWidth)
                     .required("height", &Ellipse::height, number("m", positive()), kHeight));
}

/// One time for all, or each by itself. Nothing rings for longer than a few of the largest, about
/// eleven days.
Format<DampingTimes> damping_times_format() {
  constexpr double longest = 1e6;
  const Format<double> time = number("s", Range{0.0, false, longest, false});
  const Format<DampingTimes> each =
      mapping(Table<DampingTimes>(
                  "internal damping",
                  "Times of the Kelvin-Voigt law: a strain that changes at a rate bears the "
                  "stress of itself and of what it changes by in such a time. A motion of "
                  "angular frequency w has the damping ratio time w/2. Statics and modes "
                  "are without it.")
                  .optional("bending", &DampingTimes::bending, time, "Of curvatures.")
                  .optional("twisting", &DampingTimes::twisting, time, "Of twist.")
                  .optional("stretching", &DampingTimes::stretching, time, "Of elongation."));
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = time.shape.unit;
  shape.parts = {time.shape, each.shape};
  return {std::move(shape), [time, each](const Shape& /*self*/, const Place& place,
                                         Diagnostics& diagnostics, DampingTimes& out) {
            if (place.value->mapping()) return each.read(place, diagnostics, out);
            double all = 0.0;
            if (!time.read(place, diagnostics, all)) return false;
            out = {all, all, all};
            return true;
          }};
}

constexpr const char* kDamping =
    "Internal damping: one time for bending, twisting and stretching, or each.";

/// Bending stiffnesses of which one is 0 would leave a rod that resists bending to one side only.
void check_stiffness(Stiffness& stiffness, const Place& place, Diagnostics& diagnostics) {
  if (stiffness.EI || (*stiffness.EI1 == 0.0) == (*stiffness.EI2 == 0.0)) return;
  const char* none = *stiffness.EI1 == 0.0 ? "EI1" : "EI2";
  diagnostics.add(place.at(*find_entry(*place.value->mapping(), none)),
                  "'EI1' and 'EI2' are both greater than 0, or both 0 for a cable");
}

Format<Stiffness> stiffness_format() {
  return mapping(
      Table<Stiffness>("stiffness",
                       "The stiffnesses themselves, for a cross-section of any other "
                       "kind. Such a rod has no `material`.")
          .required("EA", &Stiffness::EA, number("N", positive()), "Against stretching.")
          .optional("EI", &Stiffness::EI, number("N m^2", not_negative()),
                    "Against bending to any side; 0 makes a cable, which does not resist it.")
          .optional("EI1", &Stiffness::EI1, number("N m^2", not_negative()),
                    "Against bending toward the director (that of the width).")
          .optional("EI2", &Stiffness::EI2, number("N m^2", not_negative()),
                    "Against bending across the director: without one, in the plane of a planar "
                    "scene.")
          .either({{"EI"}, {"EI1", "EI2"}})
          .optional("GJ", &Stiffness::GJ, number("N m^2", positive()),
                    "Against twisting; needed where the scene twists.")
          .required("mass_per_length", &Stiffness::mass_per_length, number("kg/m", not_negative()),
                    "Mass per rest length.")
          .optional("rotary_inertia", &Stiffness::rotary_inertia, number("kg m", not_negative()),
                    "Mass moment of inertia about the tangent per rest length, for the spin of "
                    "sections.",
                    "that of a homogeneous section, mass_per_length (EI1 + EI2)/EA")
          .optional("damping", &Stiffness::damping, damping_times_format(), kDamping, "none")
          .check(check_stiffness));
}

Format<SectionText> cross_section_format() {
  return mapping(
      Table<SectionText>("cross-section", "Exactly one of the kinds, and where it points.")
          .kind("circle", circle_format(), assign_kind, "A solid round rod.")
          .kind("tube", tube_format(), assign_kind, "A hollow round rod.")
          .kind("rectangle", rectangle_format(), assign_kind, "A rectangular rod.")
          .kind("ellipse", ellipse_format(), assign_kind, "An elliptic rod.")
          .kind("stiffness", stiffness_format(), assign_kind,
                "The stiffnesses themselves; then without `material`.")
          .optional("director", &SectionText::director, vector(""),
                    "Direction of the width where the rod begins, of any length. It is made "
                    "perpendicular to the rod and goes along it without twist.",
                    "[0, 0, 1]"));
}

Format<Material> material_format() {
  return mapping(
      Table<Material>("material", "A linearly elastic material.")
          .required("youngs_modulus", &Material::youngs_modulus, number("Pa", positive()),
                    "Young's modulus.")
          .optional("poissons_ratio", &Material::poissons_ratio,
                    number("", Range{-1.0, true, 0.5, false}),
                    "Poisson's ratio, which gives the shear modulus. A scene that twists "
                    "needs one of the two.")
          .optional("shear_modulus", &Material::shear_modulus, number("Pa", positive()),
                    "Shear modulus.")
          .at_most_one({{"poissons_ratio"}, {"shear_modulus"}})
          .required("density", &Material::density, number("kg/m^3", not_negative()),
                    "Density; 0 for a rod whose mass is only in its spheres.")
          .optional("damping", &Material::damping, damping_times_format(), kDamping, "none"));
}

Format<Sphere> sphere_format() {
  return mapping(
      Table<Sphere>("sphere",
                    "Rigid spheres on nodes. A later entry replaces an earlier one on "
                    "the same node.")
          .required("at", &Sphere::at, location(), "The node, or all; there has to be a node.")
          .required("radius", &Sphere::radius, number("m", positive()), "Radius.")
          .required("density", &Sphere::density, number("kg/m^3", not_negative()), "Density."));
}

Format<NaturalCurvature> natural_curvature_format() {
  const Format<double> constant = number("1/m");
  const Format<std::vector<double>> list = list_of(number("1/m"), 1);
  const Format<CurvaturePair> both = pair("1/m");
  const Format<std::vector<CurvaturePair>> pairs = list_of(both, 1);
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = constant.shape.unit;
  shape.parts = {constant.shape, list.shape, both.shape, pairs.shape};
  return {std::move(shape),
          [constant, list, pairs](const Shape& /*self*/, const Place& place,
                                  Diagnostics& diagnostics, NaturalCurvature& out) {
            const Sequence* items = place.value->sequence();
            if (!items) return constant.read(place, diagnostics, out.emplace<double>());
            if (!items->empty() && items->front().sequence()) {
              return pairs.read(place, diagnostics, out.emplace<std::vector<CurvaturePair>>());
            }
            // A pair is told from a list by the checks, which know the scene's vectors.
            return list.read(place, diagnostics, out.emplace<std::vector<double>>());
          }};
}

Format<NaturalTwist> natural_twist_format() {
  const Format<double> constant = number("rad/m");
  const Format<std::vector<double>> list = list_of(constant, 1);
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = constant.shape.unit;
  shape.parts = {constant.shape, list.shape};
  return {std::move(shape), [constant, list](const Shape& /*self*/, const Place& place,
                                             Diagnostics& diagnostics, NaturalTwist& out) {
            if (place.value->sequence()) {
              return list.read(place, diagnostics, out.emplace<std::vector<double>>());
            }
            return constant.read(place, diagnostics, out.emplace<double>());
          }};
}

Format<Velocities> velocities_format() {
  const Format<Components> one = vector("m/s");
  const Format<std::vector<Components>> list = list_of(one, 1);
  Shape shape{Shape::Kind::AnyOf};
  shape.unit = one.shape.unit;
  shape.parts = {one.shape, list.shape};
  return {std::move(shape), [one, list](const Shape& /*self*/, const Place& place,
                                        Diagnostics& diagnostics, Velocities& out) {
            const Sequence* items = place.value->sequence();
            if (items && !items->empty() && items->front().sequence()) {
              return list.read(place, diagnostics, out.emplace<std::vector<Components>>());
            }
            return one.read(place, diagnostics, out.emplace<Components>());
          }};
}

Format<CurvatureMeasure> curvature_format() {
  return choice<CurvatureMeasure>(
      {{{"angle", "the turning angle at a node: second order from coarse meshes on"},
        CurvatureMeasure::Angle},
       {{"tangent", "the classic 2 tan(turning angle / 2)"}, CurvatureMeasure::Tangent}});
}

Format<ArcTo> arc_format() {
  return mapping(
      Table<ArcTo>("arc", "A part of a circle.")
          .required("to", &ArcTo::to, vector("m"), "Where it ends.")
          .optional("through", &ArcTo::through, vector("m"), "A point on it between its ends.")
          .optional("centre", &ArcTo::centre, vector("m"),
                    "Centre of the circle, as far from both ends to four digits. It gives the "
                    "shorter of two arcs.")
          .optional("radius", &ArcTo::radius, number("m"),
                    "In a plane: the radius, positive if the arc turns to the left "
                    "(counter-clockwise), negative if to the right. It gives the shorter of two "
                    "arcs.")
          .optional("longer", &ArcTo::longer, boolean(),
                    "With `centre` or `radius`: whether it is the longer of the two arcs.")
          .either({{"through"}, {"centre"}, {"radius"}}));
}

Format<HelixAround> helix_format() {
  return mapping(
      Table<HelixAround>("helix", "A helix in space; with pitch 0 a circle.")
          .required("axis", &HelixAround::axis, space_vector(""),
                    "Direction of its axis, of any length. The helix turns about it by the "
                    "right-hand rule.")
          .optional("centre", &HelixAround::centre, space_vector("m"),
                    "A point of the axis. The radius is the distance of the helix's start.")
          .optional("radius", &HelixAround::radius, number("m", positive()),
                    "Radius. The start is then on the side of +x of the axis, or of +y where the "
                    "axis runs along x.")
          .either({{"centre"}, {"radius"}})
          .required("pitch", &HelixAround::pitch, number("m"),
                    "How far it goes along the axis in a turn. Negative: against the axis, as a "
                    "left-handed helix.")
          .required("turns", &HelixAround::turns, number("", positive()), "Number of turns."));
}

/// Exactly one of the kinds.
Format<SegmentText> segment_format() {
  const auto assign_segment = [](SegmentText& segment, auto&& kind) {
    segment.what = std::forward<decltype(kind)>(kind);
  };
  return mapping(
      Table<SegmentText>("segment",
                         "A part of a rod's shape. It begins where the one before ends, the first "
                         "one at `from`.")
          .kind(
              "line", vector("m"),
              [](SegmentText& segment, Components&& to) { segment.what = LineTo{std::move(to)}; },
              "A straight line to this point.")
          .kind("arc", arc_format(), assign_segment, "An arc.")
          .kind("helix", helix_format(), assign_segment, "A helix, in space.")
          .kind(
              "spline", list_of(vector("m"), 1),
              [](SegmentText& segment, std::vector<Components>&& points) {
                segment.what = SplineThrough{std::move(points)};
              },
              "A cubic spline through these points."));
}

}  // namespace

Format<RodText> rod_format() {
  constexpr double max_nodes = 1'000'000;
  return mapping(
      Table<RodText>(
          "rod",
          "An elastic rod, drawn as a straight line, by segments or by its nodes, or as a "
          "ring of such.")
          .required("name", &Rod::name, name(),
                    "Supports, loads, probes and override paths refer to it.")
          .optional(
              "subdivide", &RodText::subdivide, integer({1, false, max_nodes}),
              "With `shape`, and in a scene with joints: into how many each element is cut that "
              "`nodes` gives.",
              "1")
          .optional(
              "nodes", &RodText::nodes, integer({2, false, max_nodes}),
              "Number of nodes, evenly spaced over `from` .. `to`, or over each part of `shape` "
              "between corners and jumps of its curvature; a rod bends at its inner nodes, so "
              "it takes 3 to bend.")
          .optional("from", &RodText::from, vector("m"), "Where the rod begins.")
          .optional("to", &RodText::to, vector("m"), "Last node of a straight rod.")
          .optional("shape", &RodText::shape, list_of(segment_format(), 1),
                    "The curve of the rod, segment by segment.")
          .optional("points", &RodText::given_points, list_of(vector("m"), 2),
                    "The nodes, one by one.")
          .either({{"nodes", "from", "to"}, {"nodes", "from", "shape"}, {"points"}})
          .optional("rest_length", &Rod::rest_length, number("m", positive()),
                    "Length without stress, for a cable that is longer than its span or a string "
                    "that is shorter: from half the length as drawn to twice. All edges share the "
                    "difference alike, and the angles between them stay free of stress. The rod "
                    "starts as drawn, compressed or stretched.",
                    "as drawn")
          .required("cross_section", &RodText::section, cross_section_format(),
                    "Shape and size across the rod.")
          .optional("material", &Rod::material, material_format(),
                    "Material of the rod; needed with every cross-section but `stiffness`.")
          .optional("curvature", &Rod::curvature, curvature_format(),
                    "Measure of bending at a node.")
          .optional("natural_curvature", &Rod::natural_curvature, natural_curvature_format(),
                    "Curvature without stress: in a scene of two components a number, positive "
                    "counter-clockwise, or one for each node; in a scene of three the curvatures "
                    "toward the director (that of the width) and across it, or a list of such with "
                    "one for each node.",
                    "as drawn")
          .optional("natural_twist", &Rod::natural_twist, natural_twist_format(),
                    "Twist without stress, right-handed: a number, or one for each node.",
                    "as drawn")
          .optional("initial_twist", &Rod::initial_twist, number("rad/m"),
                    "Twist as drawn, right-handed: the director turns about the rod so much.")
          .optional("closed", &Rod::closed, boolean(),
                    "Whether the rod is a ring: one more edge joins the last node and the first, "
                    "which is not repeated. A `shape` leads back to `from`.")
          .optional("initial_velocity", &RodText::given_velocity, velocities_format(),
                    "One vector for all nodes, or one for each.", "at rest")
          .optional("spheres", &Rod::spheres, list_of(sphere_format(), 0),
                    "Rigid spheres on nodes."));
}

}  // namespace der::scenario
