#pragma once

#include <memory>

#include "der/steppers/stepper.hpp"

namespace der {

// One maker for each stepper's file; `registry.cpp` lists them.
std::unique_ptr<Stepper> make_implicit_euler(const Model&, const Assembler&, LinearSolver&,
                                             const NewtonOptions&);
std::unique_ptr<Stepper> make_explicit_euler(const Model&, const Assembler&, LinearSolver&,
                                             const NewtonOptions&);

}  // namespace der
