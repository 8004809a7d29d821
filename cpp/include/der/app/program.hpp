#pragma once

namespace der::app {

/// All of der_run: reads the command line, runs the scene, prints, and returns the exit code.
int run_program(int argc, const char* const* argv);

}  // namespace der::app
