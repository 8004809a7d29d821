#include "state.hpp"

#include <pybind11/stl.h>

#include <cctype>
#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "arrays.hpp"
#include "bindings.hpp"
#include "der/model/fields.hpp"

namespace der::python {
namespace {

constexpr const char* kKind = "der.State";

[[noreturn]] void refuse(const std::string& why) {
  throw py::value_error("this is not a saved state of this version of der: " + why +
                        ". Save it anew with save_state");
}

// A state goes into a pickle as the lists of its fields say: a struct is a dict by the names of its
// fields, a Vector an array, a list a list of dicts, an alternative its name and its dict.

template <class Value>
py::object dump(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) {
    return py::cast(value);
  } else if constexpr (std::is_same_v<Value, Vector>) {
    return Array(value.size(), value.data());
  } else if constexpr (IsList<Value>::value) {
    py::list items;
    for (const auto& item : value) items.append(dump(item));
    return std::move(items);
  } else if constexpr (IsVariant<Value>::value) {
    return std::visit(
        [](const auto& held) -> py::object {
          return py::make_tuple(std::decay_t<decltype(held)>::kName, dump(held));
        },
        value);
  } else {
    py::dict fields;
    for_each_field(
        value, [&](const auto& field, const auto& member) { fields[field.name] = dump(member); });
    return std::move(fields);
  }
}

template <class Container>
Container cast_to(const py::handle& dumped, const std::string& name) {
  if (!py::isinstance<Container>(dumped)) refuse("'" + name + "' is of another type");
  return py::reinterpret_borrow<Container>(dumped);
}

Vector read_vector(const py::handle& dumped, const std::string& name) {
  const auto array = py::array_t<double, py::array::c_style>::ensure(dumped);
  if (!array || !py::isinstance<Array>(dumped) || array.ndim() != 1) {
    PyErr_Clear();
    refuse("'" + name + "' must be an array of doubles of one dimension");
  }
  return Eigen::Map<const Vector>(array.data(), array.size());
}

template <class Value>
void read(const py::handle& dumped, const std::string& name, Value& value);

/// The alternative of that name; refused where there is none.
template <class... T>
void read_alternative(const py::tuple& dumped, const std::string& name, std::variant<T...>& value) {
  if (dumped.size() != 2) refuse("'" + name + "' must be a name and its content");
  const auto held = dumped[0].cast<std::string>();
  const auto try_one = [&](auto fresh) {
    if (held != decltype(fresh)::kName) return false;
    read(dumped[1], name + "." + held, fresh);
    value = std::move(fresh);
    return true;
  };
  if (!(try_one(T{}) || ...)) refuse("'" + name + "' knows no '" + held + "'");
}

template <class Struct>
void read_fields(const py::dict& dumped, const std::string& name, Struct& value) {
  for_each_field(value, [&](const auto& field, auto& member) {
    const std::string path = name.empty() ? field.name : name + "." + field.name;
    if (!dumped.contains(field.name)) refuse("'" + path + "' is missing");
    read(dumped[field.name], path, member);
  });
  if (dumped.size() != std::tuple_size_v<decltype(Struct::fields())>) {
    refuse((name.empty() ? "it" : "'" + name + "'") + std::string(" has a field too many"));
  }
}

template <class Value>
void read(const py::handle& dumped, const std::string& name, Value& value) {
  if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) {
    try {
      value = dumped.cast<Value>();
    } catch (const py::cast_error&) {
      refuse("'" + name + "' is of another type");
    }
  } else if constexpr (std::is_same_v<Value, Vector>) {
    value = read_vector(dumped, name);
  } else if constexpr (IsList<Value>::value) {
    for (const py::handle& item : cast_to<py::list>(dumped, name)) {
      read(item, name, value.emplace_back());
    }
  } else if constexpr (IsVariant<Value>::value) {
    read_alternative(cast_to<py::tuple>(dumped, name), name, value);
  } else {
    read_fields(cast_to<py::dict>(dumped, name), name, value);
  }
}

py::tuple dump_state(const SavedState& saved) {
  return py::make_tuple(kKind, kStateVersion, saved.num_nodes, saved.dimension, dump(saved.state),
                        dump(saved.controls));
}

SavedState revive(const py::tuple& dumped) {
  try {
    if (dumped.size() < 2 || dumped[0].cast<std::string>() != kKind) refuse("other content");
    if (const auto version = dumped[1].cast<std::int64_t>(); version != kStateVersion) {
      refuse("it is of version " + std::to_string(version) + ", not " +
             std::to_string(kStateVersion));
    }
    if (dumped.size() != 6) refuse("other content");
    SavedState saved;
    saved.num_nodes = dumped[2].cast<Index>();
    saved.dimension = dumped[3].cast<Index>();
    read(dumped[4], "", saved.state);
    read(dumped[5], "controls", saved.controls);
    const Eigen::Index dofs = saved.state.positions.size();
    if (saved.dimension != 2 && saved.dimension != 3) refuse("another number of dimensions");
    if (saved.num_nodes < 1 || saved.num_nodes > dofs / saved.dimension) {
      refuse("another number of nodes");
    }
    if (saved.state.velocities.size() != dofs) refuse("as many velocities as positions are needed");
    return saved;
  } catch (const py::cast_error&) {
    refuse("a part of another type");
  }
}

void bind_energies(py::module_& module) {
  py::class_<Energies> energies(module, "Energies", "Energies of a state [J].");
  for (const EnergyTermInfo& row : kEnergyTerms) {
    std::string meaning = std::string(row.meaning) + " [J].";
    meaning.front() = static_cast<char>(std::toupper(meaning.front()));
    energies.def_property_readonly(
        row.name, [term = row.term](const Energies& e) { return e[term]; }, meaning.c_str());
  }
  energies
      .def_property_readonly("elastic", &Energies::elastic,
                             "Energy stored in rods, springs and foundations [J].")
      .def_property_readonly("total", &Energies::total, "The sum of all [J].")
      .def("__repr__", [](const Energies& e) {
        std::string terms;
        for (const EnergyTermInfo& row : kEnergyTerms) {
          terms += (terms.empty() ? "" : ", ") + std::string(row.name) + "=" +
                   py::str("{:.6g}").format(e[row.term]).cast<std::string>();
        }
        return "Energies(" + terms + ") J";
      });
}

}  // namespace

SavedState saved_state(const Model& model, const State& state) {
  return {state, model.num_nodes, model.dimension, control_names(model)};
}

void bind_state(py::module_& module) {
  bind_energies(module);
  py::class_<SavedState>(
      module, "State",
      "A saved state of a simulation: positions, velocities, time, written extra "
      "forces and what the\ntime integrator remembers. It can be pickled; "
      "restoring it goes back bit for bit.")
      .def_property_readonly(
          "time", [](const SavedState& s) { return s.state.time; }, "Time [s].")
      .def_property_readonly(
          "step_count", [](const SavedState& s) { return s.state.step; }, "Steps done.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            const auto& saved = self.cast<const SavedState&>();
            return read_only_view(saved.state.positions, saved.num_nodes, saved.dimension, self);
          },
          "Node positions [m], shape (nodes, dim), read-only.")
      .def_property_readonly(
          "velocities",
          [](const py::object& self) {
            const auto& saved = self.cast<const SavedState&>();
            return read_only_view(saved.state.velocities, saved.num_nodes, saved.dimension, self);
          },
          "Node velocities [m/s], shape (nodes, dim), read-only.")
      .def(py::pickle(&dump_state, &revive))
      .def("__repr__", [](const SavedState& s) {
        return py::str("<der.State at t = {:.6g} s after {} steps, {} nodes>")
            .format(s.state.time, s.state.step, s.num_nodes);
      });
}

}  // namespace der::python
