#pragma once

#include <string>
#include <vector>

#include "der/assembly/assembler.hpp"
#include "der/core/cancel_callback.hpp"
#include "der/model/model.hpp"
#include "der/model/state.hpp"
#include "der/solvers/linear_solver.hpp"

namespace der {

/// Moves `State::followed` to a shape that a program has written, with the angles of its sections
/// or without. Without them the state's own angles count, as long as it tells its turns
/// (`lost_angles`). Else the sections turn to where they are in balance in the shape, and between
/// two clamps they twist by what these have turned. A shape tells that up to two turns; if one of
/// the values that it allows leaves the nodes in balance, it is that one. Returns warnings, one of
/// each rod whose turns the shape leaves open.
std::vector<std::string> follow_written_shape(const Model& model, const Assembler& assembler,
                                              LinearSolver& solver, bool angles_are_written,
                                              const CancelCallback& beat, State& state);

}  // namespace der
