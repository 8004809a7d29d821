#pragma once

#include <memory>

#include "der/steppers/stepper.hpp"
#include "der/steppers/tableau.hpp"

namespace der {

// The makers of the steppers; `make_stepper.cpp` lists them.

/// Maker of diagonally implicit Runge-Kutta methods; the .cpp instantiates it for each tableau.
template <const Tableau& tableau>
std::unique_ptr<Stepper> make_runge_kutta(const Model&, const Assembler&, LinearSolver&,
                                          const StepperOptions&);
std::unique_ptr<Stepper> make_energy_momentum(const Model&, const Assembler&, LinearSolver&,
                                              const StepperOptions&);
std::unique_ptr<Stepper> make_generalized_alpha(const Model&, const Assembler&, LinearSolver&,
                                                const StepperOptions&);
std::unique_ptr<Stepper> make_newmark(const Model&, const Assembler&, LinearSolver&,
                                      const StepperOptions&);
std::unique_ptr<Stepper> make_bdf2(const Model&, const Assembler&, LinearSolver&,
                                   const StepperOptions&);
std::unique_ptr<Stepper> make_verlet(const Model&, const Assembler&, LinearSolver&,
                                     const StepperOptions&);
std::unique_ptr<Stepper> make_explicit_euler(const Model&, const Assembler&, LinearSolver&,
                                             const StepperOptions&);

}  // namespace der
