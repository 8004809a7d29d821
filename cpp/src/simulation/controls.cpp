// Values that a program sets in place of tables: loads, prescribed motions, actuations.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "der/core/error.hpp"
#include "der/core/printable.hpp"
#include "der/scenario/load.hpp"
#include "der/scenario/scenario.hpp"
#include "der/scenario/stretch_profile.hpp"
#include "der/simulation.hpp"
#include "scenario/suggestion.hpp"

namespace der {
namespace {

using scenario::listed;

constexpr double kEndless = std::numeric_limits<double>::infinity();

/// The components of supports that programs move.
constexpr std::array kMoved{"x", "y", "z", "angle", "twist"};

std::vector<std::string> names_of(const std::vector<ControlComponent>& components) {
  std::vector<std::string> names;
  for (const ControlComponent& component : components) names.push_back(component.name);
  return names;
}

/// Why a part of the scene that has a name has nothing to set, and what to write.
struct WhyNothing {
  std::string operator()(const scenario::Moment& /*load*/) const {
    return "the clamp at its node takes it up";
  }
  template <class Kind>
  std::string operator()(const Kind& /*load*/) const {
    return fmt::format("a load of the kind '{}' has no value that a program sets", Kind::kKey);
  }
};

/// The same by the name; "" if the scene has no such name.
std::string why_nothing(const scenario::Scene& scene, const std::string& name) {
  if (name.empty()) return {};  // as loads without a name have it
  for (const auto& support : scene.supports) {
    if (support.name != name) continue;
    return "this support prescribes nothing: give it 'prescribe', as in 'prescribe: {x: 0}'";
  }
  for (const auto& load : scene.loads) {
    if (load.name == name) return std::visit(WhyNothing{}, load.what);
  }
  return {};
}

/// Tells what to write in the scene for a name that it does not have.
std::string how_to_name(const scenario::Scene& scene, const std::string& name,
                        const std::vector<NamedControl>& named) {
  const auto is_kind = [&](const auto& load) {
    return scenario::load_kinds()[load.what.index()] == name;
  };
  if (std::any_of(scene.loads.begin(), scene.loads.end(), is_kind)) {
    return fmt::format(". Give that load a name: '- {{name: {}, {}: ...}}'", name, name);
  }
  if (named.empty()) {
    return ". Give a load a name, as '- {name: push, point_force: {...}}', or a support with "
           "'prescribe'";
  }
  std::vector<std::string> names;
  for (const NamedControl& control : named) names.push_back(control.name);
  const std::string near = scenario::did_you_mean(name, names);
  return near.empty() ? "; there is " + listed(names) : near;
}

std::string unknown_component(const NamedControl& control, const std::string& component,
                              const Model& model, const scenario::Scene& scene) {
  const char* hint = "";
  const bool is_support =
      std::any_of(scene.supports.begin(), scene.supports.end(),
                  [&](const scenario::Support& support) { return support.name == control.name; });
  if (is_support) {
    hint = ". To set it, give it a value under 'prescribe' in the scene";
  } else if (model.dimension == 2 && component == "z") {
    hint = ". This model is planar: to leave the plane, write 'model: spatial'";
  }
  return fmt::format("'{}' has no component '{}'; it has {}{}", control.name, component,
                     listed(names_of(control.components)), hint);
}

std::string not_settable(std::string_view given, const Model& model, const scenario::Scene& scene) {
  const std::string name = printable(given);
  const std::size_t dot = name.find('.');
  const std::string first = name.substr(0, dot);
  if (dot != std::string::npos) {
    for (const NamedControl& control : model.named) {
      if (control.name == first)
        return unknown_component(control, name.substr(dot + 1), model, scene);
    }
  }
  const std::string why = why_nothing(scene, first);
  if (!why.empty()) return fmt::format("'{}' cannot be set: {}", first, why);
  const std::string& whole = first.empty() ? name : first;
  return fmt::format("nothing that could be set has the name '{}'{}", whole,
                     how_to_name(scene, whole, model.named));
}

/// Throws Error if the scene has no support of that number.
void check_support(std::size_t support, const scenario::Scene& scene) {
  const std::size_t count = scene.supports.size();
  if (support < count) return;
  throw Error("model_error",
              fmt::format("there is no support {}: the scene has {}", support,
                          count == 0 ? "none" : fmt::format("{}, counted from 0", count)));
}

/// The first control that moves this component; Error if the scene prescribes none.
const PrescribedControl& check_prescribed(const Model& model, const scenario::Scene& scene,
                                          std::size_t support, const std::string& component) {
  check_support(support, scene);
  if (std::find(kMoved.begin(), kMoved.end(), component) == kMoved.end()) {
    throw Error("model_error",
                fmt::format("a support has no component '{}' to move: there are {}",
                            printable(component), listed({kMoved.begin(), kMoved.end()})));
  }
  std::string known;
  for (const PrescribedControl& candidate : model.prescribed) {
    if (candidate.support == support && candidate.component == component) return candidate;
    const std::string name =
        fmt::format("{} of support {}", candidate.component, candidate.support);
    if (known.find(name) == std::string::npos) known += (known.empty() ? "" : ", ") + name;
  }
  throw Error(
      "model_error",
      fmt::format("the scene does not prescribe {} of support {} (counted from 0): give that "
                  "support 'prescribe: {{{}: 0}}'; it prescribes {}",
                  component, support, component, known.empty() ? "nothing" : known));
}

bool is_elongation(const Model& model, Index control) {
  return std::any_of(model.rods.begin(), model.rods.end(), [control](const RodMesh& rod) {
    return std::any_of(rod.actuated_stretches.begin(), rod.actuated_stretches.end(),
                       [control](const ActuatedStretch& stretch) {
                         return stretch.what == scenario::Actuated::Length &&
                                stretch.controls[0] == control;
                       });
  });
}

std::string half_a_turn(const SharpTurn& turn, const Model& model) {
  return fmt::format(
      "{} would turn the edges of rod '{}' at node {} by {:.3g} rad without stress, and edges turn "
      "by less than half a turn: set smaller curvatures, or give the rod about {:g} nodes",
      listed(turn.names), turn.rod, turn.node, turn.angle,
      scenario::fine_nodes(turn.curvature, model.rod(turn.rod).rest_length()));
}

}  // namespace

const Simulation::Settable& Simulation::settable(std::string_view name) const {
  const auto found = constants_->settable.find(name);
  if (found != constants_->settable.end()) return found->second;
  throw Error("model_error", not_settable(name, model_, scenario_.scene()));
}

void Simulation::set(std::string_view name, const std::vector<double>& values,
                     std::optional<double> over) {
  const Settable& found = settable(name);
  const double end = end_of_ramp(over);
  check_values(found, values, end);
  check_turns(found, values, end);
  const double* value = values.data();
  for (const ControlComponent* each = found.begin; each != found.end; ++each, ++value) {
    for (const Index control : each->controls) drive(control, *value, end);
  }
}

std::vector<double> Simulation::value(std::string_view name) const {
  const Settable& found = settable(name);
  std::vector<double> values;
  values.reserve(found.size());
  for (const ControlComponent* each = found.begin; each != found.end; ++each) {
    values.push_back(control_value(model_, state_, each->controls.front()));
  }
  return values;
}

void Simulation::check_values(const Settable& found, const std::vector<double>& values,
                              double end) {
  const std::string& name = found.whole->name;
  if (values.size() != found.size()) {
    throw Error("model_error", fmt::format("'{}' takes {} value{}, for {}, but here {} {}", name,
                                           found.size(), found.size() == 1 ? "" : "s",
                                           listed(names_of({found.begin, found.end})),
                                           values.size() == 1 ? "is" : "are", values.size()));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const ControlComponent& component = found.begin[i];
    for (const Index control : component.controls) {
      const std::string problem = why_not(control, values[i], end);
      if (problem.empty()) continue;
      throw Error("model_error", fmt::format("'{}': {} {}", name, component.name, problem));
    }
  }
}

std::string Simulation::why_not(Index control, double value, double end) {
  if (!std::isfinite(value)) return fmt::format("must be finite, got {}", value);
  if (model_.load_variation && model_.load_variation->controls.change[control] != 0.0) {
    return "follows the load factor of the scene's analysis: set it in a scene that does not vary "
           "it, such as one with 'analysis: static'";
  }
  if (value <= -1.0 && is_elongation(model_, control)) {
    return fmt::format("must be greater than -1, at which the stretch has no length left, got {:g}",
                       value);
  }
  if (elongation_limits_.empty()) return {};
  return why_too_short({control, state_.time, end, control_value(model_, state_, control), value});
}

std::string Simulation::why_too_short(const Ramp& ramp) {
  if (!elongation_limits_.sums(ramp.control)) return {};
  std::optional<ShortenedEdge> found = elongation_limits_.shortest(model_, state_, ramp.end, &ramp);
  for (const Ramp& other : state_.ramps) {
    if (found) break;
    if (other.control == ramp.control || other.end <= state_.time) continue;
    found = elongation_limits_.shortest(model_, state_, other.end, &ramp);
  }
  if (!found) return {};
  const auto of_others = found->of_others(ramp.control);
  return fmt::format(
      "must be greater than {:.4g}{}{}: the edge from {:.6g} m to {:.6g} m would be shortened by "
      "{:.4g} of its length{}, got {:g}",
      found->least_of(ramp.control), of_others.empty() ? "" : " while ", of_others, found->from,
      found->to, found->shortening,
      found->at_clamp ? ", and one beside a clamp needs a quarter" : "", ramp.to);
}

void Simulation::check_turns(const Settable& found, const std::vector<double>& values, double end) {
  if (turning_limits_.empty() || !turning_limits_.bends(found.begin->controls.front())) return;
  const std::optional<SharpTurn> turn =
      turning_limits_.sharpest(model_, state_, {found.begin, values.data(), values.size(), end});
  if (!turn) return;
  if (!turn->is_possible) throw Error("model_error", half_a_turn(*turn, model_));
  if (!coarse_rods_.insert(turn->rod).second) return;
  warnings_.push_back(
      fmt::format("rod '{}' is too coarse for {}: without stress the edges turn by {:.2g} rad at "
                  "node {}. Give it about {:g} nodes",
                  turn->rod, listed(turn->names), turn->angle, turn->node,
                  scenario::fine_nodes(turn->curvature, model_.rod(turn->rod).rest_length())));
}

void Simulation::check_rest_shape() {
  if (state_.ramps.empty()) return;
  const double end = end_of_ramp(std::nullopt);
  if (!turning_limits_.empty()) {
    const std::optional<SharpTurn> turn = turning_limits_.sharpest(model_, state_, end);
    if (turn && !turn->is_possible) {
      throw Error("model_error",
                  fmt::format("at t = {:.6g} s {}", end, half_a_turn(*turn, model_)));
    }
  }
  if (elongation_limits_.empty()) return;
  const std::optional<ShortenedEdge> found = elongation_limits_.shortest(model_, state_, end);
  if (!found) return;
  throw Error("model_error",
              fmt::format("at t = {:.6g} s {} would shorten the edge of rod '{}' from {:.6g} m to "
                          "{:.6g} m by {:.4g} of its length: set greater elongations",
                          end, found->of_others(-1), found->rod, found->from, found->to,
                          found->shortening));
}

double Simulation::end_of_ramp(std::optional<double> over) const {
  if (!scenario_.scene().is_dynamic()) return state_.time;
  if (over) {
    if (*over > 0.0 && std::isfinite(*over)) return state_.time + *over;
    throw Error("model_error",
                fmt::format("the time over which a value is reached must be greater than 0 s and "
                            "finite, got {} s",
                            *over));
  }
  if (!adaptive_) return next_time();
  const bool beyond = state_.time >= horizon_;
  return adaptive_->end_of_next_step(state_, beyond ? kEndless : horizon_);
}

void Simulation::drive(Index control, double value, double end) {
  Ramp ramp{control, state_.time, end, control_value(model_, state_, control), value};
  const auto known =
      std::find_if(state_.ramps.begin(), state_.ramps.end(),
                   [control](const Ramp& earlier) { return earlier.control == control; });
  // In statics what was set before has not been reached yet, unless an equilibrium was found there.
  if (known != state_.ramps.end() && !scenario_.scene().is_dynamic()) ramp.from = known->from;
  const auto past = [&](double time) {
    if (known != state_.ramps.end()) return known->past(time);
    return control_value(model_, state_, control, time);
  };
  ramp.step = state_.last_step;
  ramp.before = past(state_.time - ramp.step);
  ramp.earlier = past(state_.time - 2.0 * ramp.step);
  if (known == state_.ramps.end()) {
    state_.ramps.push_back(ramp);
  } else {
    *known = ramp;
  }
}

void Simulation::prescribe(std::size_t support, const std::string& component, double value) {
  check_prescribed(model_, scenario_.scene(), support, component);
  const double end = end_of_ramp(std::nullopt);
  for (const PrescribedControl& moved : model_.prescribed) {
    if (moved.support != support || moved.component != component) continue;
    if (const std::string problem = why_not(moved.control, value, end); !problem.empty()) {
      throw Error("model_error", fmt::format("support {}: {} {}", support, component, problem));
    }
    drive(moved.control, value, end);
  }
}

std::vector<std::string> Simulation::prescribed_components(std::size_t support) const {
  check_support(support, scenario_.scene());
  std::vector<std::string> components;
  for (const PrescribedControl& moved : model_.prescribed) {
    if (moved.support == support) components.push_back(moved.component);
  }
  return components;
}

double Simulation::prescribed(std::size_t support, const std::string& component) const {
  const PrescribedControl& found = check_prescribed(model_, scenario_.scene(), support, component);
  return control_value(model_, state_, found.control);
}

}  // namespace der
