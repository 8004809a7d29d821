#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <type_traits>

#include "der/core/error.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {
namespace {

[[noreturn]] void refuse(const std::string& problem) { throw Error("model_error", problem); }

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// Entries that a model wants of a Vector; none where it does not say.
std::optional<Eigen::Index> entries(Extent extent, const Model& model) {
  if (extent == Extent::Dofs) return model.num_dofs();
  if (extent == Extent::Followed) return num_followed(model);
  return std::nullopt;
}

const char* counted_by(Extent extent) {
  return extent == Extent::Dofs ? "degrees of freedom"
                                : "turns at springs and clamps, and numbers of frames,";
}

void check_sizes(const Model& model, const State& state) {
  for_each_value(state, [&](const auto& field, const auto& value) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Vector>) {
      const Eigen::Index wanted = entries(field.extent, model).value_or(value.size());
      if (value.size() == wanted) return;  // before the message is made, which takes long
      refuse(
          fmt::format("the state has {} {} in its {}, this simulation has {}: a state can only "
                      "be restored into a simulation of the same rods and supports",
                      value.size(), counted_by(field.extent), in_words(field.name), wanted));
    }
  });
}

void check_ramps(const Model& model, const std::vector<Ramp>& ramps) {
  for (const Ramp& ramp : ramps) {
    if (!model.can_set(ramp.control)) {
      refuse(
          "the state sets a value that this scene neither prescribes nor names: a state can "
          "only be restored into a simulation of the same rods, supports and loads");
    }
    if (!(ramp.start <= ramp.end)) {
      refuse(fmt::format("the state sets a value between t = {} and {} s: these must be in order",
                         ramp.start, ramp.end));
    }
  }
}

bool fits(double value, Values values) {
  if (values == Values::Any) return true;
  return std::isfinite(value) && (values == Values::Finite || value >= 0.0);
}

/// The first number of a field that does not fit; none: all do.
template <class Number>
std::optional<double> find_misfit(Number value, Values values) {
  const auto number = static_cast<double>(value);
  return fits(number, values) ? std::nullopt : std::optional(number);
}

std::optional<double> find_misfit(const Vector& vector, Values values) {
  for (const double value : vector) {
    if (!fits(value, values)) return value;
  }
  return std::nullopt;
}

}  // namespace

std::string find_wrong_value(const State& state) {
  std::string problem;
  for_each_value(state, [&](const auto& field, const auto& value) {
    if (!problem.empty()) return;
    const std::optional<double> wrong = find_misfit(value, field.values);
    if (!wrong) return;
    problem =
        fmt::format("the {} of the state is {}: it must be a finite number{}", in_words(field.name),
                    *wrong, field.values == Values::NotNegative ? ", 0 or greater" : "");
  });
  return problem;
}

void check_state(const Model& model, const State& state) {
  check_sizes(model, state);
  if (const std::string wrong = find_wrong_value(state); !wrong.empty()) refuse(wrong);
  check_ramps(model, state.ramps);
  if (model.load_variation || state.load_factor == 1.0) return;
  refuse(
      fmt::format("the state is one at the load factor {:g}, but this scene varies no loads: it "
                  "can only be restored into a simulation of the same continuation",
                  state.load_factor));
}

}  // namespace der
