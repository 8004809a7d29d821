#pragma once

#include <filesystem>
#include <variant>
#include <vector>

#include "der/app/exit_code.hpp"
#include "der/scenario/reader.hpp"

namespace der::app {

/// The command line of der_run.
struct Options {
  std::filesystem::path scene;
  std::filesystem::path out;  ///< of the run folder
  std::vector<Override> overrides;
  bool check = false;
  bool resume = false;
  bool quiet = false;
  bool verbose = false;
  bool schema = false;
};

/// Reads the command line. Where there is nothing left to do (--help, --version, a usage error, all
/// of which it prints), the exit code.
std::variant<Options, ExitCode> parse_options(int argc, const char* const* argv);

}  // namespace der::app
