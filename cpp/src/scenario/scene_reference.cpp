#include <fmt/core.h>

#include <set>
#include <string>
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

A scene is one YAML file. All values are in SI units and are written as plain decimal numbers:
`0.5`, `.5`, `-2`, `1e-3`. Numbers with a unit (`5 mm`), a leading zero (`010`) or separators
(`1_000`), other bases, infinities and NaN are refused; so is `2.0` where a whole number is needed.
Truth values are `true` and `false`, also as `True` and `FALSE`; `yes` and `on` are refused. Names are
made of letters, digits, `_` and `-` and do not start with a digit. Unknown, duplicate and missing keys are errors. YAML anchors and aliases work; tags,
merge keys and several documents in one file do not.

A value is overridden by its path: keys and list items joined by dots, items by their `name` or their
number, as in `rods.beam.nodes=101` or `loads.0.gravity=[0, -1.62]`. An empty value removes what the
path names.

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
a planar rod bends toward its height. From edge to edge the directors go along the rod without twist;
`initial_twist` turns them further. Twist is positive when it is right-handed about the tangent.

`natural_curvature` is a number, or a list of one for each node, in a scene of two components; in a
scene of three it is a pair `[k1, k2]`, or a list with a pair for each node. A number still means a
curvature about z there, of a rod drawn without twist at one z; 0 is a rod that is straight without
stress. At the node of a jump a list has the mean of the cell there: of edges of one length, half of
the sum of both sides. `natural_twist` is a number, or a list of one for each node.
)";

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
    text_ += fmt::format("\n<a id=\"{}\"></a>\n\n## {}\n\n{}\n\n", anchor(table), title, table.doc);
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
