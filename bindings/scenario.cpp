#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arguments.hpp"
#include "bindings.hpp"
#include "der/scenario/document.hpp"
#include "der/scenario/number_with_unit.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"
#include "der/scenario/series.hpp"
#include "values.hpp"

namespace der::python {
namespace {

/// Throws SceneError for a str that UTF-8 has no form for.
std::string text_of(const py::handle& text) {
  return std::get<std::string>(to_document_value(text, "").content);
}

std::vector<Override> to_overrides(const py::kwargs& values) {
  std::vector<Override> overrides;
  for (const auto& [key, value] : values) {
    const std::string path = text_of(key);
    overrides.emplace_back(path, scenario::to_flow_yaml(to_document_value(value, path)));
  }
  return overrides;
}

Scenario load(const py::object& path, const py::kwargs& overrides) {
  py::object as_text;
  try {
    as_text = py::module_::import("os").attr("fspath")(path);
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError)) throw;
    throw py::type_error("a scene is loaded from the path of its file, got " +
                         py::repr(path).cast<std::string>() +
                         "; Scenario.from_dict takes a dict, Scenario.parse a text");
  }
  return Scenario::load(as_text.cast<std::filesystem::path>(), to_overrides(overrides));
}

Scenario parse(const Text& text, const Text& source, const py::kwargs& overrides) {
  text.check("the text of a scene");
  return Scenario::parse(text_of(text.given), std::string(source.value("the name of the source")),
                         to_overrides(overrides));
}

Scenario with(const Scenario& scenario, const py::args& others, const py::kwargs& overrides) {
  if (!others.empty()) {
    throw py::type_error(
        "with_ takes values by their key paths: write with_(**{\"rods.beam.nodes\": 101})");
  }
  return scenario.with(to_overrides(overrides));
}

Scenario from_dict(const py::object& scene) {
  if (!PyDict_Check(scene.ptr())) {
    throw py::type_error("a scene is a dict with the keys of a scene file, got " +
                         py::repr(scene).cast<std::string>());
  }
  return Scenario::from_document(
      std::make_shared<const scenario::Document>(to_document_value(scene, "")));
}

py::str repr(const Scenario& scenario) {
  const std::string& source = scenario.source();
  return py::str("<der.Scenario {!r}{}>")
      .format(scenario.scene().title, source.empty() ? "" : " from " + source);
}

using ScenarioClass = py::class_<Scenario>;

void bind_readers(ScenarioClass& cls) {
  cls.def_static("load", &load, py::arg("path"), py::pos_only(),
                 "Read and validate a scene file.\n\n"
                 "Keyword arguments replace values, as in `with_`. Raises SceneError with every "
                 "diagnostic.")
      .def_static("parse", &parse, py::arg("text"), py::arg("source") = "scene", py::pos_only(),
                  "Read and validate a scene given as YAML text; `source` names it in messages.\n\n"
                  "Keyword arguments replace values, as in `with_`. Raises SceneError.")
      .def_static("from_dict", &from_dict, py::arg("scene"),
                  "Validate a scene given as a dict, with the keys of a scene file.\n\n"
                  "Values may be None, bool, int, float, str, lists, tuples, dicts, NumPy scalars\n"
                  "and arrays. Raises SceneError, whose messages name the key path.")
      .def("with_", &with,
           "Return the same scene with some values replaced or added, validated again.\n\n"
           "A key path names mappings by key and list items by `name` or number:\n"
           "`scenario.with_(**{\"rods.beam.nodes\": 101, \"loads.0.gravity\": [0, -1.6]})`.");
}

/// First and last factor of a continuation.
std::optional<std::pair<double, double>> factor_range(const Scenario& scenario) {
  const auto* path = std::get_if<scenario::ContinuationAnalysis>(&scenario.scene().analysis);
  if (path == nullptr) return std::nullopt;
  return std::pair{path->from, path->to};
}

bool varies_load(const Scenario& scenario, const WholeNumber& load) {
  const std::int64_t number = load.at_least(0, "the number of the load");
  const auto* path = std::get_if<scenario::ContinuationAnalysis>(&scenario.scene().analysis);
  return path != nullptr && path->vary == scenario::Varied::Loads &&
         path->number.value_or(number) == number;
}

void bind_facts(ScenarioClass& cls) {
  cls.def_property_readonly(
         "title", [](const Scenario& s) { return s.scene().title; }, "The scene's title.")
      .def_property_readonly("source", &Scenario::source,
                             "Name of the file or text; empty for a dict.")
      .def_property_readonly(
          "is_static", [](const Scenario& s) { return !s.scene().is_dynamic(); },
          "Whether the scene asks for an analysis of equilibria, not for a motion.")
      .def_property_readonly(
          "analysis", [](const Scenario& s) { return s.scene().analysis_name(); },
          "``dynamic``, ``static``, ``modes``, ``buckling`` or ``continuation``.")
      .def_property_readonly(
          "duration", [](const Scenario& s) { return s.scene().time.duration; },
          "Duration of the motion [s]; 0 for a static scene.")
      .def_property_readonly("factor_range", &factor_range,
                             "First and last load factor of a continuation; None without one.")
      .def(
          "varies_load", &varies_load, py::arg("number"),
          "Return whether the factor of a continuation scales a load of the scene, counted from 0.")
      .def_property_readonly(
          "warnings",
          [](const Scenario& s) {
            py::list warnings;
            for (const std::string& warning : s.scene().warnings) warnings.append(warning);
            return py::tuple(warnings);
          },
          "Warnings: parts of the scene that can be run but are probably not intended.")
      .def("to_yaml", &Scenario::to_yaml,
           "Return the scene as YAML text that reads back to the same scene.")
      .def(
          "to_dict", [](const Scenario& s) { return to_python(s.document().root()); },
          "Return the scene as a new dict: values with a unit are numbers in SI units; defaults "
          "are\n"
          "not filled in.")
      .def("__repr__", &repr)
      .def(py::pickle([](const Scenario& s) { return py::make_tuple(s.to_yaml(), s.source()); },
                      [](const py::tuple& dumped) {
                        return Scenario::parse(dumped[0].cast<std::string>(),
                                               dumped[1].cast<std::string>());
                      }));
}

}  // namespace

void bind_scenario(py::module_& module) {
  ScenarioClass cls(module, "Scenario",
                    "A validated scene. It never changes; `with_` makes a new one.\n\n"
                    "Made by `load`, `parse` or `from_dict`.");
  bind_readers(cls);
  bind_facts(cls);
  module.def(
      "table_value",
      [](std::vector<double> times, std::vector<double> values, double time, bool smooth) {
        scenario::Series table{std::move(times), std::move(values)};
        if (smooth) table.course.kind = scenario::Course::Kind::Smooth;
        return scenario::value_at(table, time);
      },
      py::arg("times"), py::arg("values"), py::arg("time"), py::arg("smooth") = false,
      "Return the value of a table over time at `time` [s]: linear between entries, or smooth, and "
      "constant beyond both ends.");
  module.def(
      "sine_value",
      [](double amplitude, double frequency, double phase, double offset, double time) {
        const scenario::Series sine{
            {}, {offset, amplitude}, {scenario::Course::Kind::Sine, frequency, phase}};
        return scenario::value_at(sine, time);
      },
      py::arg("amplitude"), py::arg("frequency"), py::arg("phase"), py::arg("offset"),
      py::arg("time"),
      "Return offset + amplitude sin(2 pi frequency t + phase) at `time` [s]; `frequency` in Hz, "
      "`phase` in rad.");
  module.def(
      "number_with_unit", [](const std::string& text) { return scenario::number_with_unit(text); },
      py::arg("text"),
      "Return the number in SI units of a text such as `5 mm`; None for every other text.");
  module.def("json_schema", &json_schema,
             "Return the JSON Schema of a scene file, as text, for editors.");
  module.def("scene_reference", &scene_reference,
             "Return the reference of all scene keys, in Markdown.");
}

}  // namespace der::python
