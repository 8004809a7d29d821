#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "der/core/error.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"

namespace der {
namespace {

void demand(bool fits, const std::string& problem) {
  if (fits) return;
  throw Error("model_error", problem);
}

void check_sizes(const Model& model, const State& state) {
  const auto check = [](Eigen::Index size, Index wanted, const char* what) {
    demand(size == wanted,
           fmt::format("the state has {} {}, this simulation has {}: a state can only be restored "
                       "into a simulation of the same rods and supports",
                       size, what, wanted));
  };
  const Index dofs = model.num_dofs();
  check(state.positions.size(), dofs, "degrees of freedom");
  check(state.velocities.size(), dofs, "velocities");
  check(state.extra_force.size(), dofs, "extra forces");
  check(state.accelerations.size(), dofs, "accelerations");
  for (const Vector& vector : state.history) check(vector.size(), dofs, "values of the past");
  check(state.turns.size(), static_cast<Index>(model.followed_edges.size()),
        "turns at springs and clamps");
}

void check_times(const State& state) {
  const std::array<std::pair<double, const char*>, 4> values{{{state.time, "time"},
                                                              {state.last_step, "last step"},
                                                              {state.next_step, "next step"},
                                                              {state.last_error, "last error"}}};
  for (const auto& [value, what] : values) {
    demand(std::isfinite(value) && value >= 0.0,
           fmt::format("the {} of the state is {}: it must be a finite number, 0 or greater", what,
                       value));
  }
  demand(state.step >= 0,
         fmt::format("the state counts {} steps: it must be 0 or more", state.step));
}

void check_ramps(const Model& model, const std::vector<Ramp>& ramps) {
  for (const Ramp& ramp : ramps) {
    const bool known =
        std::any_of(model.prescribed.begin(), model.prescribed.end(),
                    [&](const PrescribedControl& moved) { return moved.control == ramp.control; });
    demand(known,
           "the state moves a support that this scene does not prescribe: a state can only be "
           "restored into a simulation of the same rods and supports");
    const std::array<double, 4> values{ramp.start, ramp.end, ramp.from, ramp.to};
    demand(
        std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); }) &&
            ramp.start <= ramp.end,
        fmt::format("the state moves a support from {} to {} between t = {} and {} s: these must "
                    "be finite numbers, the times in order",
                    ramp.from, ramp.to, ramp.start, ramp.end));
  }
}

}  // namespace

void check_state(const Model& model, const State& state) {
  check_sizes(model, state);
  check_times(state);
  check_ramps(model, state.ramps);
  demand(state.turns.allFinite(), "a turn of the state is not a finite number");
}

}  // namespace der
