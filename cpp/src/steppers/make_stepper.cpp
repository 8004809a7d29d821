#include <string_view>

#include "der/core/error.hpp"
#include "der/steppers/stepper.hpp"
#include "steppers/steppers.hpp"

namespace der {
namespace {

struct Maker {
  std::string_view name;
  std::unique_ptr<Stepper> (*make)(const Model&, const Assembler&, LinearSolver&,
                                   const StepperOptions&);
};

/// One for each stepper of the catalog.
constexpr Maker kMakers[] = {
    {"implicit_euler", make_runge_kutta<kImplicitEuler>},
    {"implicit_midpoint", make_runge_kutta<kImplicitMidpoint>},
    {"energy_momentum", make_energy_momentum},
    {"generalized_alpha", make_generalized_alpha},
    {"newmark", make_newmark},
    {"bdf2", make_bdf2},
    {"tr_bdf2", make_runge_kutta<kTrBdf2>},
    {"sdirk4", make_runge_kutta<kSdirk4>},
    {"sdirk5", make_runge_kutta<kSdirk5>},
    {"verlet", make_verlet},
    {"explicit_euler", make_explicit_euler},
};

}  // namespace

std::unique_ptr<Stepper> make_stepper(std::string_view name, const Model& model,
                                      const Assembler& assembler, LinearSolver& solver,
                                      const StepperOptions& options) {
  for (const Maker& maker : kMakers) {
    if (name == maker.name) return maker.make(model, assembler, solver, options);
  }
  throw Error("model_error", "no stepper is made for integrator '" + std::string(name) + "'");
}

}  // namespace der
