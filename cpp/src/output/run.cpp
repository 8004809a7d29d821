#include "der/output/run.hpp"

#include "der/core/error.hpp"

namespace der {
namespace {

std::string advance(Simulation& simulation, Recorder& recorder, const StepCallback& after_step) {
  recorder.observe(simulation);
  while (!simulation.finished()) {
    simulation.step();
    recorder.observe(simulation);
    if (after_step && !after_step(simulation) && !simulation.finished()) return "stopped";
  }
  return "completed";
}

}  // namespace

RunOutcome run(Simulation& simulation, Recorder& recorder, const StepCallback& after_step) {
  const bool is_static = !simulation.scenario().scene().is_dynamic();
  RunOutcome outcome;
  const auto fail = [&](const Error& error) {
    outcome.status = error.status();
    outcome.message = error.what();
  };
  try {
    if (is_static) {
      outcome.equilibrium = simulation.equilibrium(
          std::get<scenario::StaticAnalysis>(simulation.scenario().scene().analysis).leave_saddles);
      recorder.observe(simulation);
      outcome.status = "static_converged";
    } else {
      outcome.status = advance(simulation, recorder, after_step);
    }
  } catch (const NotConvergedError& error) {
    fail(error);
  } catch (const DivergedError& error) {
    fail(error);
  }
  // An equilibrium that was not found leaves nothing to record.
  if (recorder.has_data()) recorder.finish(simulation);
  outcome.time = simulation.state().time;
  outcome.counters = recorder.counters(simulation);
  outcome.wall_seconds = recorder.wall_seconds();
  return outcome;
}

}  // namespace der
