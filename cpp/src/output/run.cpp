#include "der/output/run.hpp"

#include "der/catalog/run_status.hpp"
#include "der/core/error.hpp"
#include "der/scenario/scenario.hpp"

namespace der {
namespace {

std::string advance(Simulation& simulation, Recorder& recorder, const StepCallback& after_step) {
  recorder.observe(simulation);
  while (!simulation.finished()) {
    simulation.step();
    recorder.observe(simulation);
    if (after_step && !after_step(simulation) && !simulation.finished()) {
      if (simulation.state().step >= EnergyMonitor::kStride) simulation.audit_energy();
      return run_status::kStopped;
    }
  }
  return run_status::kCompleted;
}

/// Does one kind of analysis, puts its results into the outcome and its shapes into the recorder.
/// Returns the status.
struct Analyse {
  Simulation& simulation;
  Recorder& recorder;
  const StepCallback& after_step;
  const CancelCallback& beat;
  RunOutcome& outcome;

  std::string operator()(const scenario::DynamicAnalysis& /*analysis*/) const {
    return advance(simulation, recorder, after_step);
  }
  std::string operator()(const scenario::StaticAnalysis& analysis) const {
    outcome.equilibrium = simulation.equilibrium(analysis.leave_saddles, beat);
    recorder.observe(simulation);
    return run_status::kStaticConverged;
  }
  std::string operator()(const scenario::ModesAnalysis& analysis) const {
    outcome.equilibrium = simulation.equilibrium(true, beat);
    outcome.modes = simulation.modes(analysis.count, beat);
    const auto& plane = outcome.equilibrium->out_of_plane;
    if (plane && plane->stability.unstable_directions > 0) {
      outcome.out_of_plane.growth_rate = simulation.growth_rate_out_of_plane(beat);
    }
    recorder.observe(simulation);
    return run_status::kCompleted;
  }
  std::string operator()(const scenario::BucklingAnalysis& analysis) const {
    outcome.buckling = simulation.buckling(analysis.count, beat);
    outcome.out_of_plane.buckling = simulation.buckling_out_of_plane(outcome.buckling, beat);
    recorder.observe(simulation);
    return run_status::kCompleted;
  }
  std::string operator()(const scenario::ContinuationAnalysis& /*analysis*/) const {
    outcome.path = simulation.follow(beat);
    std::int64_t index = 0;
    for (const PathBranch& branch : outcome.path) {
      for (const PathPoint& point : branch.points) {
        simulation.show(point, index++);
        recorder.observe(simulation);
        auto& probes = outcome.path_probes.emplace_back();
        for (const ProbeSummary& probe : recorder.summaries()) probes.push_back(probe.final);
      }
    }
    return run_status::kCompleted;
  }
};

}  // namespace

RunOutcome run(Simulation& simulation, Recorder& recorder, const StepCallback& after_step,
               const CancelCallback& beat) {
  RunOutcome outcome;
  const auto fail = [&](const Error& error) {
    outcome.status = error.status();
    outcome.message = error.what();
    outcome.error = std::current_exception();
  };
  try {
    outcome.status = std::visit(Analyse{simulation, recorder, after_step, beat, outcome},
                                simulation.scenario().scene().analysis);
  } catch (const NotConvergedError& error) {
    fail(error);
  } catch (const DivergedError& error) {
    fail(error);
  } catch (const Stopped&) {
    outcome = {};
    outcome.status = run_status::kStopped;
  }
  // An equilibrium that was not found leaves nothing to record.
  if (recorder.has_data()) recorder.finish(simulation);
  outcome.crossing = recorder.crossing();
  outcome.strained = recorder.strained();
  outcome.time = simulation.state().time;
  outcome.counters = recorder.counters(simulation);
  outcome.wall_seconds = recorder.wall_seconds();
  return outcome;
}

}  // namespace der
