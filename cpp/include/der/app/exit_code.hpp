#pragma once

namespace der::app {

/// The exit codes of der_run; listed in `der_run --help` and docs/results.md.
enum class ExitCode : int {
  Completed = 0,
  SceneError = 1,
  Usage = 2,
  NumericalFailure = 3,
  IoFailure = 4,
  InternalError = 70,
  Interrupted = 130,  ///< 128 + the number of the signal Ctrl-C sends
  Terminated = 143,   ///< 128 + the number of the signal `kill` and batch systems send
};

}  // namespace der::app
