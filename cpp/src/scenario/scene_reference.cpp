#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "der/scenario/reader.hpp"
#include "scenario/scene_text.hpp"

namespace der {
namespace {

using scenario::Alternatives;
using scenario::FieldInfo;
using scenario::Shape;
using scenario::TableInfo;
using scenario::Word;

constexpr const char* kIntroduction = R"(# Scene reference

This page is made from the tables that the scene reader itself works with.

A scene is one YAML file. Values are plain decimal numbers in SI units: `0.5`, `.5`, `-2`, `1e-3`.
Numbers with a leading zero (`010`) or separators (`1_000`), other bases, infinities and NaN are
refused; so is `2.0` where a whole number is needed.

A unit of the same kind as that of the key may stand behind a number, in lists and tables too: `5 mm`,
`[0, -2 kN]`, `1 GPa`, `1.2 g/cm^3`, `3 kN m`, `30 deg`, `20 ms`. Units are made of `m`, `g`, `s`, `rad`,
`N`, `Pa`, `Hz` with the prefixes `n`, `u`, `m`, `c`, `d`, `k`, `M`, `G`, and of `deg` (or `°`), `turn`,
`min` and `h`. A product has a blank, `*` or `·`, a quotient `/`, a power `^2` (`m2` and `m²` are the
same). `5 mm` is the same number as `5e-3`, which is what saved scenes say. A unit of another kind is
refused, and so is every unit where the key has none. Curvatures are in `1/m`; `rad/m` is a twist.

Truth values are `true` and `false`, also as `True` and `FALSE`; `yes` and `on` are refused. Names are
made of letters, digits, `_` and `-` and do not start with a digit. Unknown, duplicate and missing keys are errors. YAML anchors and aliases work; tags,
merge keys and several documents in one file do not.

A value is overridden by its path: keys and list items joined by dots, items by their `name` or their
number, as in `rods.beam.nodes=101` or `loads.0.gravity=[0, -1.62]`. An empty value removes what the
path names.

Supports and loads of the plane, as pictures draw them:

![Symbols of supports and loads](images/symbols.png)

## Planes and space

Vectors have two components, `[x, y]`, or three, `[x, y, z]`. All vectors of a scene have three as
soon as one has. `model: auto` takes the smallest model that can represent the scene, and the summary
says why:

- `planar` has x and y of each node. It takes scenes that lie in the x-y plane: positions, velocities,
  loads, prescribed motions, clamps that turn about z alone; and rods that bend in the plane and do not
  twist: the width or the height of every section lies in the plane (or its two bending stiffnesses
  are equal), natural curvature is about z, there is no initial, natural or prescribed twist.
- `spatial_bend` has x, y and z of each node. It takes rods that provably do not twist: the two
  bending stiffnesses are equal, the rod is straight without stress (or has no bending stiffness), has
  no initial or natural twist, no moment acts on it, no support twists it or spins its section over
  time, and at most one support holds its section (`clamp: true`; `clamp: tangent` holds none). A
  closed rod that leaves the plane is twisted by its writhe, and has the next model. The spin inertia
  of sections is left out; a scene that gives `rotary_inertia` and moves has the next model, too.
- `spatial` has x, y and z of each node and the angle of each edge's section. It needs a stiffness
  against twisting: `poissons_ratio` or `shear_modulus` of the material, or `GJ`.

Nothing is rounded to the plane: a node 1e-6 m off it is part of the scene, as a seed of buckling out
of the plane is. A larger model than needed may be asked for; a smaller one is refused, with the
reason. The integrator `energy_momentum` is for the planar model only.

A probe chooses no model, and the model that `auto` takes changes no probe: the components of the
scene's vectors tell what a quantity means. In a scene of three components `curvature` and `moment` are
magnitudes, `z` and `torque` of a rod in the plane are 0, `moment_1` is the part of its moment towards
director 1, and quantities of the plane alone, such as `slope`, are refused. So a sweep may pass a
scene that is flat. `model: planar` has the quantities of the plane. A rod of the model `spatial_bend`
has components towards directors where a clamp holds its section.

Vibration modes of a scene of three components are those in space; `model: planar` has those in the
plane.

The section of a rod has two directors: director 1 is the direction of its width, director 2 that of
its height, t x d1 with the tangent t in the direction of growing arc length. `EI1` and `k1` belong to
bending toward director 1, `EI2` and `k2` to bending toward director 2. The `director` of a
cross-section is that of the width where the rod begins; without it the width points along z, so that
a planar rod bends toward its height.

![A strip with its tangent and its two directors](images/directors.png)

From edge to edge the directors go along the rod without twist;
`initial_twist` turns them further. Twist is positive when it is right-handed about the tangent.

`natural_curvature` is a number, or a list of one for each node, in a scene of two components; in a
scene of three it is a pair `[k1, k2]`, or a list with a pair for each node. A number still means a
curvature about z there, of a rod drawn without twist at one z; 0 is a rod that is straight without
stress. At the node of a jump a list has the mean of the cell there: of edges of one length, half of
the sum of both sides. `natural_twist` is a number, or a list of one for each node.
)";

/// An example of a table, as lines of a scene.
struct Example {
  std::string_view table;
  std::string_view lines;
};
constexpr std::array<Example, 38> kExamples{{
    {"rod", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}})"},
    {"segment", R"(rods:
  - {name: rod, nodes: 41, from: [0, 0],
     shape: [{line: [0.5, 0]}, {arc: {to: [0.7, 0.2], radius: 200 mm}},
             {spline: [[0.6, 0.4], [0.8, 0.5], [1, 0.4]]}],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}})"},
    {"arc", R"(rods:
  - {name: rod, nodes: 41, from: [0, 0],
     shape: [{arc: {to: [1, 0], through: [0.5, 0.05]}}, {arc: {to: [1.5, 0], centre: [1.25, 1]}}],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}})"},
    {"helix", R"(rods:
  - {name: rod, nodes: 201, from: [0.1, 0, 0],
     shape: [{helix: {axis: [0, 0, 1], centre: [0, 0, 0], pitch: 30 mm, turns: 5}}],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, poissons_ratio: 0.33, density: 2700}}
loads:
  - gravity: [0, 0, -9.81])"},
    {"circle", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}})"},
    {"tube", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {tube: {inner_radius: 11 mm, outer_radius: 13 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}})"},
    {"rectangle", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {rectangle: {width: 20 mm, height: 1 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}})"},
    {"ellipse", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {ellipse: {width: 20 mm, height: 8 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}})"},
    {"stiffness", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {stiffness: {EA: 1e4, EI: 0.1, GJ: 0.08, mass_per_length: 0.05}}})"},
    {"internal damping", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 1 MPa, density: 1100, damping: {bending: 10 ms}}})"},
    {"material", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, poissons_ratio: 0.33, density: 2700}})"},
    {"sphere", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700},
     spheres: [{at: all, radius: 6 mm, density: 7000}, {at: end, radius: 2 cm, density: 7000}]})"},
    {"node", R"(loads:
  - point_force: {rod: rod, at: {node: -2}, force: [0, -2]})"},
    {"joint", R"(rods:
  - {name: beam, nodes: 11, from: [0, 0], to: [1, 0], cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}}
  - {name: post, nodes: 11, from: [1, 0], to: [1, -1], cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}}
joints:
  - {name: corner, of: [{rod: beam, at: end}, {rod: post, at: start}]}
supports:
  - {rod: post, at: end, clamp: true})"},
    {"spring between joints", R"(rods:
  - {name: mast, nodes: 11, from: [0, 0], to: [0, 1], cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}}
  - {name: anchor, nodes: 3, from: [-1, 0], to: [-1.1, 0], cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}}
joints:
  - {name: top, of: [{rod: mast, at: end}]}
  - {name: foot, of: [{rod: anchor, at: start}]}
springs:
  - {name: guy, between: [top, foot], stiffness: 5000}
supports:
  - {rod: mast, at: start, clamp: true}
  - {rod: anchor, at: start, clamp: true})"},
    {"motion of a hinge", R"(rods:
  - {name: beam, nodes: 11, from: [0, 0], to: [1, 0], cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}}
  - {name: arm, nodes: 11, from: [1, 0], to: [1, -1], cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700}}
joints:
  - {name: servo, kind: hinge, of: [{rod: beam, at: end}, {rod: arm, at: start}],
     prescribe: {angle: {times: [0, 1], values: [0, 90 deg], smooth: true}}}
supports:
  - {rod: beam, at: start, clamp: true})"},
    {"support", R"(supports:
  - {rod: rod, at: start, clamp: true}
  - {rod: rod, at: end, fix: [y]})"},
    {"prescribed motion", R"(supports:
  - {rod: rod, at: start, clamp: true,
     prescribe: {y: {times: [0, 1], values: [0, 20 mm], smooth: true}}})"},
    {"table", R"(supports:
  - {rod: rod, at: start, clamp: true,
     prescribe: {angle: {times: [0, 0.5, 1], values: [0, 90 deg, 0]}}})"},
    {"sine", R"(supports:
  - {rod: rod, at: start, clamp: true,
     prescribe: {y: {sine: {amplitude: 5 mm, frequency: 2 Hz}}}})"},
    {"rotation", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0, 0], to: [1, 0, 0], cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, poissons_ratio: 0.33, density: 2700}}
supports:
  - {rod: rod, at: start, clamp: true,
     prescribe: {rotation: {axis: [1, 0, 0], angle: {times: [0, 1], values: [0, 90 deg]}}}}
loads:
  - gravity: [0, 0, -9.81])"},
    {"spring", R"(supports:
  - {rod: rod, at: start, clamp: true}
  - {rod: rod, at: end, spring: {stiffness: [0, 500], rotational_stiffness: 2}})"},
    {"load", R"(loads:
  - gravity: [0, -9.81]
  - {name: push, point_force: {rod: rod, at: end, force: [0, -2]}})"},
    {"table of vectors", R"(loads:
  - point_force: {rod: rod, at: end,
      force: {times: [0, 0.5], values: [[0, 0], [0, -2]], smooth: true}})"},
    {"sine of vectors", R"(loads:
  - point_force: {rod: rod, at: end,
      force: {sine: {amplitude: [0, 2], frequency: 2 Hz, phase: 90 deg}}})"},
    {"damping", R"(loads:
  - damping: {coefficient: 0.5})"},
    {"point force", R"(loads:
  - point_force: {rod: rod, at: 0.75, force: [0, -2 kN]})"},
    {"moment", R"(loads:
  - moment: {rod: rod, at: end, moment: 3 N m})"},
    {"distributed force", R"(loads:
  - distributed_force: {rod: rod, from: 0.2, to: 0.8, force: [0, -100 N/m]})"},
    {"foundation", R"(loads:
  - foundation: {rod: rod, stiffness: [0, 1e4]})"},
    {"fluid", R"(rods:
  - {name: rod, nodes: 21, from: [0, 0], to: [1, 0],
     cross_section: {circle: {radius: 5 mm}},
     material: {youngs_modulus: 70 GPa, density: 2700},
     spheres: [{at: all, radius: 6 mm, density: 7000}]}
loads:
  - gravity: [0, -9.81]
  - fluid: {density: 1000, viscosity: 1 mPa s})"},
    {"actuation", R"(actuation:
  - {name: chamber, rod: rod, from: 0.1, to: 0.5,
     natural_curvature: {times: [0, 1], values: [0, 5]}})"},
    {"time", R"(time: {duration: 2 s, step: 1 ms, integrator: tr_bdf2})"},
    {"analysis", R"(analysis: {modes: {count: 3}})"},
    {"continuation", R"(analysis: {continuation: {from: 0, to: 2}})"},
    {"solver", R"(solver: {linear: banded, max_iterations: 100})"},
    {"output", R"(output:
  every: 10 ms
  probes: {tip: {rod: rod, at: end, quantity: y}})"},
    {"probe", R"(output:
  probes:
    deepest: {rod: rod, over: rod, reduce: min, quantity: y})"},
}};

std::string example(const TableInfo& table) {
  const auto* found = std::find_if(kExamples.begin(), kExamples.end(),
                                   [&](const Example& each) { return each.table == table.name; });
  return found == kExamples.end() ? "" : fmt::format("```yaml\n{}\n```\n\n", found->lines);
}

std::string anchor(const TableInfo& table) {
  std::string id = table.name;
  for (char& c : id) c = c == ' ' ? '-' : c;
  return id;
}

std::string code_list(const std::vector<std::string>& words, const std::string& last_vertex) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? last_vertex : ", ";
    text += "`" + words[i] + "`";
  }
  return text;
}

/// The allowed values of a key, as the text of a table cell.
std::string value_text(const Shape& shape) {
  const std::string range = scenario::bounds(shape.range);
  switch (shape.kind) {
    case Shape::Kind::Number:
      return range.empty() ? "number" : "number " + range;
    case Shape::Kind::Integer:
      return range.empty() ? "whole number" : "whole number " + range;
    case Shape::Kind::Boolean:
      return "`true`, `false`";
    case Shape::Kind::Text:
      return "text";
    case Shape::Kind::Name:
      return "name";
    case Shape::Kind::Choice:
      return code_list(names_of(shape.words), ", ");
    case Shape::Kind::Vector:
      return shape.min_items == 3 ? "`[x, y, z]`" : "`[x, y]`, `[x, y, z]`";
    case Shape::Kind::Pair:
      return "`[k1, k2]`";
    case Shape::Kind::Triple:
      return "`[k1, k2, kt]`";
    case Shape::Kind::List:
      return "list of: " + value_text(shape.parts.front());
    case Shape::Kind::Table:
      return fmt::format("[{}](#{})", shape.table->name, anchor(*shape.table));
    case Shape::Kind::NamedTables:
      return fmt::format("name: [{}](#{})", shape.table->name, anchor(*shape.table));
    case Shape::Kind::AnyOf:
      break;
  }
  std::string text;
  for (const Shape& part : shape.parts) text += (text.empty() ? "" : "; or ") + value_text(part);
  return text;
}

std::string default_text(const FieldInfo& field) {
  if (field.required) return "**required**";
  return field.default_is_literal ? "`" + field.default_text + "`" : field.default_text;
}

std::string row(const FieldInfo& field, const std::string& unit) {
  return fmt::format("| `{}` | {} | {} | {} | {} |\n", field.key, value_text(field.shape), unit,
                     default_text(field), field.doc);
}

std::string alternatives_text(const Alternatives& alternatives) {
  return fmt::format(
      "\nGive {} {}.\n", alternatives.required ? "either" : "at most one of",
      alternatives.described([](const auto& branch) { return code_list(branch, " and "); }));
}

/// The allowed words of a key, each with its meaning.
std::string words_text(const FieldInfo& field) {
  std::vector<const Shape*> shapes{&field.shape};
  for (const Shape& part : field.shape.parts) shapes.push_back(&part);
  std::string text;
  for (const Shape* shape : shapes) {
    for (const Word& word : shape->words) {
      if (!word.doc.empty()) text += fmt::format("- `{}`: {}\n", word.name, word.doc);
    }
  }
  return text.empty() ? text : fmt::format("\nAllowed values of `{}`:\n\n{}", field.key, text);
}

/// Writes a table, then the tables that it refers to, each once.
class ReferenceWriter {
 public:
  void write(const TableInfo& table) {
    if (!written_.insert(table.name).second) return;
    std::string title = table.name;
    title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
    text_ += fmt::format("\n<a id=\"{}\"></a>\n\n## {}\n\n{}\n\n{}", anchor(table), title,
                         table.doc, example(table));
    text_ += "| key | value | unit | default | meaning |\n|---|---|---|---|---|\n";
    for (const FieldInfo& field : table.fields) text_ += row(field, table.unit_of(field));
    for (const Alternatives& alternatives : table.alternatives) {
      text_ += alternatives_text(alternatives);
    }
    for (const FieldInfo& field : table.fields) text_ += words_text(field);
    for (const FieldInfo& field : table.fields) write_tables_of(field.shape);
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void write_tables_of(const Shape& shape) {
    if (shape.table) write(*shape.table);
    for (const Shape& part : shape.parts) write_tables_of(part);
  }

  std::set<std::string> written_;
  std::string text_;
};

}  // namespace

std::string scene_reference() {
  ReferenceWriter writer;
  writer.write(*scenario::scene_format().shape.table);
  return kIntroduction + writer.text();
}

}  // namespace der
