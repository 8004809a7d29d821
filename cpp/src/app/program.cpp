#include "der/app/program.hpp"

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <optional>
#include <string>

#include "der/app/exit_code.hpp"
#include "der/app/interrupt.hpp"
#include "der/app/options.hpp"
#include "der/app/progress.hpp"
#include "der/app/report.hpp"
#include "der/app/terminal.hpp"
#include "der/catalog/run_status.hpp"
#include "der/core/error.hpp"
#include "der/core/printable.hpp"
#include "der/output/io_error.hpp"
#include "der/output/recorder.hpp"
#include "der/output/run_folder.hpp"
#include "der/output/start.hpp"
#include "der/scenario/reader.hpp"
#include "der/scenario/scenario.hpp"
#include "der/simulation.hpp"

namespace der::app {
namespace {

void print(const std::string& text) { std::fputs(text.c_str(), stdout); }

ExitCode fail(ExitCode code, const std::string& message) {
  std::fputs((Style::of(stderr).bad("error: ") + printable(message) + "\n").c_str(), stderr);
  return code;
}

/// Every diagnostic on a line of its own, as compilers write them, so that editors can jump there.
ExitCode fail(ExitCode code, const SceneError& error) {
  std::fputs((std::string(error.what()) + "\n").c_str(), stderr);
  return code;
}

ExitCode exit_code_of_signal() {
  return InterruptGuard::signal() == SIGTERM ? ExitCode::Terminated : ExitCode::Interrupted;
}

ExitCode exit_code(const RunOutcome& outcome) {
  if (outcome.ok()) return ExitCode::Completed;
  if (outcome.failed()) return ExitCode::NumericalFailure;
  return exit_code_of_signal();
}

void stop_at_signal() {
  if (InterruptGuard::signal() != 0) throw Stopped{};
}

ExitCode run_scene(const Options& options, Simulation& simulation) {
  const RunFolder folder(options.out);
  Recorder recorder(simulation);
  Progress progress(!options.quiet);
  const auto after_step = [&](const Simulation& now) {
    progress.update([&] {
      const State& state = now.state();
      const double duration = now.scenario().scene().time.duration;
      // Adaptive steps: as many more as the time left asks for at the mean length so far.
      const std::int64_t steps =
          now.adaptive() ? std::llround(static_cast<double>(state.step) * duration / state.time)
                         : now.plan().total_steps;
      return RunPosition{state.step, steps, state.time, duration};
    });
    return InterruptGuard::signal() == 0;
  };
  // A step may take long, and is saved. An analysis has nothing to save before its end.
  const bool has_steps = simulation.scenario().scene().is_dynamic();
  const InterruptGuard guard(has_steps ? InterruptGuard::Patience::Endless
                                       : InterruptGuard::Patience::OneSecond);
  const RunOutcome outcome =
      options.resume ? resume_in_folder(folder, simulation, recorder, after_step)
                     : run_in_folder(folder, simulation, recorder, after_step, stop_at_signal);
  progress.clear();
  if (!options.quiet) {
    const Detail detail = options.verbose ? Detail::Full : Detail::Usual;
    print(run_report(simulation, recorder, outcome, folder, detail, Style::of(stdout)));
    std::fflush(stdout);
  }
  return outcome.failed() ? fail(exit_code(outcome), outcome.message) : exit_code(outcome);
}

/// True if the run is at its end already, which is said.
bool is_finished(const Options& options, const Scenario& scenario) {
  const RunFileHead head = check_resumable(RunFolder(options.out), scenario);
  if (!run_status::is_finished(head.status)) return false;
  if (!options.quiet) {
    print("the run in '" + printable(options.out.string()) + "' is finished already (" +
          head.status + "): nothing to resume\n");
  }
  return true;
}

ExitCode execute(const Options& options) {
  if (options.schema) {
    print(json_schema());
    return ExitCode::Completed;
  }
  const Scenario scenario = Scenario::load(options.scene, options.overrides);
  if (options.resume && is_finished(options, scenario)) return ExitCode::Completed;
  if (!options.quiet) {  // before what may take long
    print(scene_head(scenario, Style::of(stdout)));
    std::fflush(stdout);
  }
  std::optional<Simulation> simulation;
  try {
    // The search for the equilibrium that a motion starts from may take long.
    const InterruptGuard guard(InterruptGuard::Patience::OneSecond);
    simulation.emplace(scenario);
    if (options.check && !options.quiet) print(check_report(*simulation, Style::of(stdout)));
    if (options.check) return ExitCode::Completed;
    if (!options.resume) apply_start(*simulation, stop_at_signal);
    stop_at_signal();
  } catch (const Stopped&) {
    return fail(exit_code_of_signal(), "stopped before the run began: nothing was written");
  }
  return run_scene(options, *simulation);
}

ExitCode guarded(const Options& options) {
  try {
    return execute(options);
  } catch (const UnreadableSceneError& error) {
    return fail(ExitCode::IoFailure, error);
  } catch (const SceneError& error) {
    return fail(ExitCode::SceneError, error);
  } catch (const IoError& error) {
    return fail(ExitCode::IoFailure, error.what());
  } catch (const EnvironmentError& error) {
    return fail(ExitCode::Usage, error.what());
  } catch (const NotConvergedError& error) {
    return fail(ExitCode::NumericalFailure, error.what());
  } catch (const Error& error) {
    return fail(ExitCode::SceneError, error.what());
  } catch (const std::exception& error) {
    return fail(ExitCode::InternalError, std::string("internal error: ") + error.what());
  }
}

/// Output that did not get where it should (a full disk) must not pass for done.
ExitCode with_output_written(ExitCode code) {
  const bool written =
      std::cout.flush().good() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (written || code != ExitCode::Completed) return code;
  return fail(ExitCode::IoFailure,
              std::string("cannot write to the standard output: ") + std::strerror(errno));
}

ExitCode run(int argc, const char* const* argv) {
  const auto options = parse_options(argc, argv);
  if (const auto* code = std::get_if<ExitCode>(&options)) return *code;
  return guarded(std::get<Options>(options));
}

}  // namespace

int run_program(int argc, const char* const* argv) {
  return static_cast<int>(with_output_written(run(argc, argv)));
}

}  // namespace der::app
