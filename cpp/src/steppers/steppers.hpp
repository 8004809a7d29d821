#pragma once

#include <memory>

#include "der/steppers/stepper.hpp"

namespace der {

// One maker for each stepper's file; `registry.cpp` lists them.
std::unique_ptr<Stepper> make_implicit_euler(const Model&, const Assembler&, LinearSolver&,
                                             const StepperOptions&);
std::unique_ptr<Stepper> make_implicit_midpoint(const Model&, const Assembler&, LinearSolver&,
                                                const StepperOptions&);
std::unique_ptr<Stepper> make_energy_momentum(const Model&, const Assembler&, LinearSolver&,
                                              const StepperOptions&);
std::unique_ptr<Stepper> make_generalized_alpha(const Model&, const Assembler&, LinearSolver&,
                                                const StepperOptions&);
std::unique_ptr<Stepper> make_bdf2(const Model&, const Assembler&, LinearSolver&,
                                   const StepperOptions&);
std::unique_ptr<Stepper> make_tr_bdf2(const Model&, const Assembler&, LinearSolver&,
                                      const StepperOptions&);
std::unique_ptr<Stepper> make_sdirk4(const Model&, const Assembler&, LinearSolver&,
                                     const StepperOptions&);
std::unique_ptr<Stepper> make_sdirk5(const Model&, const Assembler&, LinearSolver&,
                                     const StepperOptions&);
std::unique_ptr<Stepper> make_verlet(const Model&, const Assembler&, LinearSolver&,
                                     const StepperOptions&);
std::unique_ptr<Stepper> make_explicit_euler(const Model&, const Assembler&, LinearSolver&,
                                             const StepperOptions&);

}  // namespace der
