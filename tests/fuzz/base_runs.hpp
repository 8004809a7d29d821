#pragma once

#include <string>
#include <vector>

namespace der::fuzz {

/// A short run of each kind of run file: its scene, and the bytes of the file as der writes it.
struct BaseRun {
  std::string scene;  ///< YAML text
  std::string bytes;
};

/// Inputs name them by number, modulo how many there are: another one would change what the
/// regressions mean.
const std::vector<BaseRun>& base_runs();

/// The folder that the target writes its files to; it is removed at the end of the process.
const std::string& scratch_folder();

}  // namespace der::fuzz
